//! The loops as the boundary of a patch, and what is around them.

use glam::DVec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::tour::Loops;
use crate::fill::even::fair::Beyond;
use crate::fill::even::local::{Local, edge};
use crate::fill::loops::check::Checked;
use crate::fill::loops::mesh::Rim;
use crate::fill::loops::reserve::wanted;
use crate::fill::one::outside;
use crate::fill::options::FillOptions;

/// The loops, as the patch's boundary runs.
#[derive(Clone, Copy)]
pub(super) struct Several<'a> {
    pub vertices: &'a [DVec3],
    pub triangles: &'a [[u32; 3]],
    pub rim: &'a Rim,
    pub options: &'a FillOptions,
    pub checked: &'a [Checked],
    /// Pairs of loops that the patch joins, see [`spanning`](super::tour::spanning).
    pub spanning: &'a [[usize; 2]],
    /// Two loops that look away from each other, if any do.
    pub apart: Option<[usize; 2]>,
}

/// Places of the loops and what is around them: all, or those that large triangles have.
pub(super) struct Border {
    pub loops: Loops,
    /// The mesh's vertices.
    pub vertices: Vec<u32>,
    pub at: Vec<DVec3>,
    /// See [`Outline`].
    pub outside: Vec<Option<DVec3>>,
    pub taken: FxHashSet<[u32; 2]>,
    pub beyond: Beyond,
    /// Wanted number of triangles at each.
    pub wanted: Vec<usize>,
    /// The places of the mesh's vertices.
    pub place: FxHashMap<u32, u32>,
}

impl Border {
    /// Only some of the places, those of each loop in order.
    pub fn picked(&self, loops: Loops, picks: &[usize]) -> Border {
        let new = picks.iter().zip(0..).map(|(&pick, k)| (pick as u32, k)).collect::<FxHashMap<u32, u32>>();
        let place = self.place.iter().filter_map(|(&v, pick)| new.get(pick).map(|&k| (v, k)));
        // As far from the loops as the larger triangles' vertices are.
        let further = |&k: &usize| {
            let (sum, count) = self.beyond[k];
            (2.0 * sum - count as f64 * self.at[k], count)
        };
        // Edges go over two of the mesh: normals of both.
        let facing = |&k: &usize| {
            let next = self.loops.next(k);
            let other = if new.contains_key(&(next as u32)) { None } else { self.outside[next] };
            let sum = self.outside[k].into_iter().chain(other).map(DVec3::normalize_or_zero).sum::<DVec3>();
            (sum != DVec3::ZERO).then_some(sum)
        };
        let both = |e: &[u32; 2]| Some(edge(*new.get(&e[0])?, *new.get(&e[1])?));
        Border {
            loops,
            vertices: picks.iter().map(|&k| self.vertices[k]).collect(),
            at: picks.iter().map(|&k| self.at[k]).collect(),
            outside: picks.iter().map(facing).collect(),
            taken: self.taken.iter().filter_map(both).collect(),
            beyond: picks.iter().map(further).collect(),
            wanted: picks.iter().map(|&k| self.wanted[k]).collect(),
            place: place.collect(),
        }
    }

    /// A patch of these triangles, the first vertices of which are those of the border.
    pub fn local(&self, positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Local {
        let sides = vec![0; triangles.len()];
        let mut local = Local::new(positions, triangles, sides, self.at.len());
        local.taken.clone_from(&self.taken);
        self.size(&mut local);
        local
    }

    /// Wanted edge lengths and numbers of triangles.
    fn size(&self, local: &mut Local) {
        let loops = &self.loops;
        for v in 0..local.border {
            let length = |a: usize, b: usize| local.positions[a].distance(local.positions[b]);
            local.sizes[v] = 0.5 * (length(v, loops.next(v)) + length(v, loops.before(v)));
        }
        let inner = local.border..local.positions.len();
        for v in inner {
            let (mut sum, mut weights) = (0.0, 0.0);
            for k in 0..local.border {
                let squared = local.positions[k].distance_squared(local.positions[v]);
                let weight = 1.0 / squared.max(f64::MIN_POSITIVE);
                sum += weight * local.sizes[k];
                weights += weight;
            }
            local.sizes[v] = sum / weights;
        }
        local.wanted.clone_from(&self.wanted);
    }
}

impl Several<'_> {
    pub(super) fn border(&self) -> Border {
        let loop_ = self.checked.iter().flat_map(|c| c.vertices.iter().copied()).collect::<Vec<_>>();
        let loops = Loops::new(self.checked.iter().map(|c| c.vertices.len()));
        let outside = self.checked.iter().flat_map(|c| outside(&c.vertices, self.rim, self.vertices));
        let wishes = self.checked.iter().flat_map(|c| wanted(&c.vertices, self.rim, &self.options.polygons));
        Border {
            at: loop_.iter().map(|&v| self.vertices[v as usize]).collect(),
            outside: outside.collect(),
            taken: self.taken(&loop_),
            beyond: self.beyond(&loops, &loop_),
            wanted: wishes.map(|edges| (edges - 1).clamp(1, 5) as usize).collect(),
            place: loop_.iter().zip(0..).map(|(&v, k)| (v, k)).collect(),
            loops,
            vertices: loop_,
        }
    }

    /// Edges that the mesh has between vertices of the loops, by their places.
    fn taken(&self, loop_: &[u32]) -> FxHashSet<[u32; 2]> {
        let places: FxHashMap<u32, u32> = loop_.iter().zip(0..).map(|(&v, k)| (v, k)).collect();
        let mut taken = FxHashSet::default();
        for (&v, k) in loop_.iter().zip(0..) {
            let near = self.rim.local(v).map(|v| self.rim.neighbours(v)).unwrap_or_default();
            let near = near.into_iter().map(|u| self.rim.ids[u as usize]);
            let loose = self.rim.loose.iter().filter(|edge| edge.contains(&v));
            for u in near.chain(loose.flatten().copied()).filter(|&u| u != v) {
                taken.extend(places.get(&u).map(|&place| edge(k, place)));
            }
        }
        taken
    }

    /// What lies beyond each vertex of the loops.
    fn beyond(&self, loops: &Loops, loop_: &[u32]) -> Beyond {
        let of = |k: usize| {
            let beside = [loop_[loops.before(k)], loop_[loops.next(k)]];
            let near = self.rim.local(loop_[k]).map(|v| self.rim.neighbours(v)).unwrap_or_default();
            let near = near.into_iter().map(|u| self.rim.ids[u as usize]).filter(|u| !beside.contains(u));
            near.fold((DVec3::ZERO, 0), |(sum, n), u| (sum + self.vertices[u as usize], n + 1))
        };
        (0..loop_.len()).map(of).collect()
    }
}

//! Replaces a region of a mesh by a grid patch on the same boundary and the same surface.

use glam::{DVec2, DVec3};
use rstar::primitives::CachedEnvelope;

use rstar::{AABB, PointDistance, RTree, RTreeObject};

use crate::geometry::facet::Facet;

use super::parallel::steady;
use crate::error::{Error, Result};
use crate::fill::even::nearest::Facets;
use crate::fill::filled::{Fill, NO_ITEM};
use crate::fill::job::Job;
use crate::fill::loops::check::check_size;
use crate::fill::loops::holes::boundary_loops;
use crate::fill::loops::mesh::{Rim, place, repeats};
use crate::fill::options::{FillOptions, Smooth};
use crate::fill::surface::fair::Membrane;
use crate::fill::surface::fit::{LEAST_WEIGHT, folds};
use crate::fill::surface::patchwork::Patchwork;
use crate::fill::surface::sweep::sweep;
use crate::progress::Progress;

/// Rounds of sweeps and projections.
const ROUNDS: usize = 6;

/// Vertices between two questions whether to go on.
const ASK_EVERY: usize = 1 << 10;

/// A region that was replaced.
#[derive(Clone, Debug)]
pub struct Regrid {
    /// The patch. Its triangles are to take the place of the region's.
    pub fill: Fill,
    /// For each new vertex the face of the mesh that it lies on (or that is nearest), and weights of that
    /// face's corners: carries over data of any kind.
    pub sources: Vec<(u32, [f64; 3])>,
    /// Vertices that only the region used, ascending.
    pub unused: Vec<u32>,
    /// Largest distance of a new vertex from the old surface.
    pub off: f64,
    /// Largest distance of a vertex that only the region used from the new surface: shape that the patch has no vertices for.
    pub lost: f64,
}

/// Replaces the triangles `faces` of a mesh, which must be a disk, by a patch on the same boundary.
///
/// With `keep_shape` the new vertices are laid on the old surface: first through a harmonic map of the
/// region into the flat patch, then by rounds of tangential relaxation and projection. Without it the
/// patch is what [`super::fill_hole`] makes of the hole. The guarantees are those of that function, with the
/// region's triangles gone.
///
/// # Errors
/// [`Error::NotADisk`] if the faces are none; [`Error::FaceOutOfRange`]; and those of
/// [`super::fill_hole`].
///
/// Source: Nealen et al. 2009, section VII, names remeshing along an enclosed area and leaves open how.
pub fn regrid(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    faces: &[u32],
    keep_shape: bool,
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Regrid> {
    steady(progress, |progress| replaced(vertices, triangles, faces, keep_shape, options, progress))
}

/// See [`regrid`].
fn replaced(
    vertices: &[DVec3],
    triangles: &[[u32; 3]],
    faces: &[u32],
    keep_shape: bool,
    options: &FillOptions,
    progress: Progress<'_>,
) -> Result<Regrid> {
    options.check(triangles)?;
    let mut chosen = vec![false; triangles.len()];
    for &face in faces {
        let mark = chosen
            .get_mut(face as usize)
            .ok_or(Error::FaceOutOfRange { index: face as i32, faces: triangles.len() })?;
        *mark = true;
    }
    let pick = |wanted: bool| -> (Vec<u32>, Vec<[u32; 3]>) {
        // Triangles that repeat a vertex are no part of a region, but their edges are not to be repeated.
        let kept =
            (0..triangles.len()).filter(|&t| chosen[t] == wanted && !(wanted && repeats(&triangles[t])));
        kept.map(|t| (t as u32, triangles[t])).unzip()
    };
    let ((numbers, region), (kept, rest)) = (pick(true), pick(false));
    let mut loops = boundary_loops(vertices.len(), &region)?;
    let mut used = region.iter().flatten().copied().collect::<Vec<_>>();
    used.sort_unstable();
    used.dedup();
    let (loop_, others) = (loops.pop(), loops.len());
    let Some(Ok(border)) = loop_ else { return Err(Error::NotADisk { faces: faces.len(), borders: others }) };
    // Euler: an edge of the border belongs to one triangle, all others to two.
    let edges = (3 * region.len() + border.len()) / 2;
    if others > 0 || used.len() + region.len() != edges + 1 {
        return Err(Error::NotADisk { faces: faces.len(), borders: others + 1 });
    }
    if let Some(&v) = used.iter().find(|&&v| !vertices[v as usize].is_finite()) {
        return Err(Error::NotFinite { what: "mesh".into(), point: v as usize });
    }
    check_size(&used, vertices)?;
    // The patch takes the region's place: it runs as the region does, against the direction of a hole in it.
    let loop_ = border.iter().rev().copied().collect::<Vec<_>>();
    let polygons = &options.polygons;
    let polygons =
        if polygons.is_empty() { vec![] } else { kept.iter().map(|&t| polygons[t as usize]).collect() };
    let options = &FillOptions { polygons, ..options.clone() };
    // What counts is where the vertices come to lie in the end.
    let first = FillOptions { smooth: Smooth::Flat, strict: false, sharp: None, ..options.clone() };
    let job = Job { vertices, triangles: &rest, options: if keep_shape { &first } else { options } };
    let mut fills = job.run(&[Ok(loop_)], progress.part(0.0, 0.5))?;
    let mut fill = fills.pop().unwrap_or(Err(NO_ITEM))?;

    let surface = Surface::new(vertices, &numbers, &region);
    if keep_shape {
        lay_back(&mut fill, vertices, &region, &surface, progress.part(0.5, 0.9))?;
        let mut items = [Ok(fill)];
        Job { options, ..job }.count_meetings(&mut items, progress.part(0.9, 1.0))?;
        let [item] = items;
        fill = item?;
    }
    let mut off = 0.0f64;
    let sources = fill.vertices.iter().enumerate().map(|(k, &p)| {
        if k % ASK_EVERY == 0 {
            progress.report(1.0)?;
        }
        let (face, weights, foot) = surface.nearest(p);
        off = off.max(foot.distance(p));
        Ok((face, weights))
    });
    let sources = sources.collect::<Result<_>>()?;
    let mut elsewhere = vec![false; vertices.len()];
    rest.iter().flatten().chain(&border).for_each(|&v| elsewhere[v as usize] = true);
    used.retain(|&v| !elsewhere[v as usize]);
    let lost = farthest(&fill, vertices, &used, progress)?;
    progress.report(1.0)?;
    Ok(Regrid { fill, sources, unused: used, off, lost })
}

/// The largest distance of some vertices from the faces of a fill.
fn farthest(fill: &Fill, vertices: &[DVec3], some: &[u32], progress: Progress<'_>) -> Result<f64> {
    let shape = fill.shape.as_ref();
    let corners = |t: &[u32; 3]| t.map(|v| shape.positions[v as usize]);
    let faces = Facets::new(shape.work.triangles[..shape.work.n_patch].iter().map(corners).collect());
    let mut most = 0.0f64;
    for (k, &v) in some.iter().enumerate() {
        if k % ASK_EVERY == 0 {
            progress.report(1.0)?;
        }
        most = most.max(faces.distance(vertices[v as usize]));
    }
    Ok(most)
}

/// Moves the new vertices of a fill onto the surface of the region.
fn lay_back(
    fill: &mut Fill,
    vertices: &[DVec3],
    region: &[[u32; 3]],
    surface: &Surface,
    progress: Progress<'_>,
) -> Result<()> {
    let shape = fill.shape.as_ref();
    let work = &shape.work;
    let mut positions = shape.positions.clone();
    for (v, p) in
        work.inner().zip(through_the_plane(shape.loop_.as_slice(), &shape.flat, vertices, region, progress)?)
    {
        positions[v] = p.unwrap_or(positions[v]);
    }
    for round in 0..ROUNDS {
        sweep(work, &mut positions);
        for v in work.inner() {
            if v % ASK_EVERY == 0 {
                progress.report(round as f64 / ROUNDS as f64)?;
            }
            positions[v] = surface.nearest(positions[v]).2;
        }
        progress.report((round + 1) as f64 / ROUNDS as f64)?;
    }
    fill.vertices = positions[work.inner()].to_vec();
    std::sync::Arc::make_mut(&mut fill.shape).positions = positions;
    fill.recut()?;
    let shape = fill.shape.as_ref();
    fill.report.folds = folds(&shape.work, &shape.positions);
    [fill.report.min_angle, fill.report.max_angle] = shape.work.corner_range(&shape.positions);
    Ok(())
}

/// Where the patch's inner vertices come to lie on the region if both are laid out in the plane on the same
/// loop; none where the harmonic map of the region leaves a gap.
fn through_the_plane(
    loop_: &[u32],
    flat: &[DVec2],
    vertices: &[DVec3],
    region: &[[u32; 3]],
    progress: Progress<'_>,
) -> Result<Vec<Option<DVec3>>> {
    let n = loop_.len();
    let mut on_loop = loop_.iter().enumerate().map(|(k, &v)| (v, k as u32)).collect::<Vec<_>>();
    on_loop.sort_unstable();
    let corner = |v: u32| on_loop.binary_search_by_key(&v, |p| p.0).ok().map(|k| on_loop[k].1);
    let mut inner = region.iter().flatten().copied().filter(|&v| corner(v).is_none()).collect::<Vec<_>>();
    inner.sort_unstable();
    inner.dedup();
    let mut old = region.to_vec();
    for v in old.iter_mut().flatten() {
        *v = match corner(*v) {
            Some(k) => k,
            None => (n + place(&inner, *v)?) as u32,
        };
    }
    let positions = loop_.iter().chain(&inner).map(|&v| vertices[v as usize]).collect::<Vec<_>>();
    let work = Patchwork::new(loop_, inner.len(), &old, &Rim::default(), 0)?;
    let mut laid = flat[..n].to_vec();
    if !inner.is_empty() {
        let weights =
            work.cotangents(&positions).into_iter().map(|w| w.max(LEAST_WEIGHT)).collect::<Vec<_>>();
        progress.report(0.0)?;
        let membrane = Membrane::new(&work, progress.part(0.0, 0.0))?;
        progress.report(0.0)?;
        let inside = membrane.harmonic(&weights, |v| flat[v].to_array(), progress.part(0.0, 0.0))?;
        laid.extend(inside.into_iter().map(DVec2::from));
    }
    progress.report(0.0)?;
    let boxes = old.iter().enumerate().map(|(i, t)| {
        let [a, b, c] = t.map(|v| laid[v as usize]);
        let rectangle = rstar::primitives::Rectangle::from_corners(
            a.min(b).min(c).to_array(),
            a.max(b).max(c).to_array(),
        );
        rstar::primitives::GeomWithData::new(rectangle, i)
    });
    let tree = RTree::bulk_load(boxes.collect());
    let find = |(k, p): (usize, &DVec2)| -> Result<Option<DVec3>> {
        if k % ASK_EVERY == 0 {
            progress.report(0.0)?;
        }
        let near = tree.locate_in_envelope_intersecting(AABB::from_point(p.to_array()));
        // Where the map folds, the triangle in which the point lies deepest; equal ones by number.
        let depth = |i: usize| {
            let [a, b, c] = old[i].map(|v| laid[v as usize] - *p);
            let areas = [b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)];
            let sum = areas[0] + areas[1] + areas[2];
            let weights = areas.map(|area| area / sum);
            (weights[0].min(weights[1]).min(weights[2]), weights)
        };
        let hits = near.map(|b| (b.data, depth(b.data))).filter(|(_, (least, _))| *least >= -1e-9);
        let best = hits.min_by(|a, b| b.1.0.total_cmp(&a.1.0).then(a.0.cmp(&b.0)));
        Ok(best.map(|(face, (_, weights))| {
            let corners = old[face].map(|v| positions[v as usize]);
            (0..3).map(|k| weights[k] * corners[k]).sum()
        }))
    };
    flat[n..].iter().enumerate().map(find).collect()
}

/// The region as a set of triangles to project to.
struct Surface {
    tree: RTree<CachedEnvelope<Face>>,
}

struct Face {
    number: u32,
    facet: Facet,
}

impl Surface {
    fn new(vertices: &[DVec3], numbers: &[u32], region: &[[u32; 3]]) -> Self {
        // Their boxes are asked for again and again while the tree is made.
        let face = |(&number, t): (&u32, &[u32; 3])| {
            let facet = Facet::new(t.map(|v| vertices[v as usize]));
            CachedEnvelope::new(Face { number, facet })
        };
        Surface { tree: RTree::bulk_load(numbers.iter().zip(region).map(face).collect()) }
    }

    /// The nearest face, weights of its corners, and the point itself.
    fn nearest(&self, p: DVec3) -> (u32, [f64; 3], DVec3) {
        match self.tree.nearest_neighbor(p.to_array()) {
            Some(face) => (face.number, face.facet.closest(p).1, face.facet.place(p)),
            None => (0, [1.0, 0.0, 0.0], p),
        }
    }
}

impl RTreeObject for Face {
    type Envelope = AABB<[f64; 3]>;

    fn envelope(&self) -> Self::Envelope {
        self.facet.bounds()
    }
}

impl PointDistance for Face {
    fn distance_2(&self, point: &[f64; 3]) -> f64 {
        self.facet.closest(DVec3::from_array(*point)).0.powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::metrics::check_mesh;

    /// A bumpy sheet of n x n quads.
    fn sheet(n: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let at = |i: u32, j: u32| i * (n + 1) + j;
        let height = |i: u32, j: u32| 0.8 * (0.5 * f64::from(i)).sin() * (0.4 * f64::from(j)).cos();
        let vertices = (0..=n)
            .flat_map(|i| (0..=n).map(move |j| DVec3::new(f64::from(i), f64::from(j), height(i, j))))
            .collect();
        let mut triangles = vec![];
        for i in 0..n {
            for j in 0..n {
                triangles.push([at(i, j), at(i + 1, j), at(i, j + 1)]);
                triangles.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        (vertices, triangles)
    }

    #[test]
    fn a_region_keeps_its_shape_and_border() {
        let (vertices, triangles) = sheet(16);
        let inside = |t: &[u32; 3]| {
            let middle = t.iter().map(|&v| vertices[v as usize]).sum::<DVec3>() / 3.0;
            middle.truncate().distance(DVec2::new(8.0, 8.0)) < 5.0
        };
        let faces =
            (0..triangles.len() as u32).filter(|&t| inside(&triangles[t as usize])).collect::<Vec<_>>();
        let options = FillOptions::default();
        let done = regrid(&vertices, &triangles, &faces, true, &options, Progress::NONE).unwrap();
        assert!(done.off < 1e-9 && done.lost < 0.5, "{} {}", done.off, done.lost);
        let mut all = (0..triangles.len() as u32)
            .filter(|t| !faces.contains(t))
            .map(|t| triangles[t as usize])
            .collect::<Vec<_>>();
        all.extend(&done.fill.triangles);
        let mut points = vertices.clone();
        points.extend(&done.fill.vertices);
        let check = check_mesh(points.len(), &all);
        assert_eq!((check.bad_edges, check.bad_vertices, check.boundaries), (0, 0, 1), "{check:?}");
        let used = all.iter().flatten().collect::<std::collections::BTreeSet<_>>();
        assert!(done.unused.iter().all(|v| !used.contains(v)));
        for (p, (face, weights)) in done.fill.vertices.iter().zip(&done.sources) {
            let corners = triangles[*face as usize].map(|v| vertices[v as usize]);
            let there = (0..3).map(|k| weights[k] * corners[k]).sum::<DVec3>();
            assert!(there.distance(*p) < 1e-9);
            assert!(faces.contains(face));
        }
    }

    #[test]
    fn lost_shape_is_told() {
        let (mut vertices, triangles) = sheet(16);
        // Between the vertices of the patch, but for chance.
        vertices[8 * 17 + 8].z += 6.0;
        let all = (0..triangles.len() as u32).collect::<Vec<_>>();
        let done =
            regrid(&vertices, &triangles, &all, true, &FillOptions::default(), Progress::NONE).unwrap();
        assert!(done.lost > 1.0 && done.lost < 6.0, "{}", done.lost);
    }

    #[test]
    fn what_is_no_disk_is_refused() {
        let (vertices, triangles) = sheet(6);
        let all = (0..triangles.len() as u32).collect::<Vec<_>>();
        let ring = all.iter().copied().filter(|t| !(28..32).contains(t)).collect::<Vec<_>>();
        let options = FillOptions::default();
        let kind = |faces: &[u32]| {
            regrid(&vertices, &triangles, faces, true, &options, Progress::NONE)
                .err()
                .map_or("", |e| e.kind())
        };
        assert_eq!(kind(&ring), "not_a_disk");
        assert_eq!(kind(&[]), "not_a_disk");
        assert_eq!(kind(&[0, 40]), "not_a_disk");
        assert_eq!(kind(&[900]), "index_out_of_range");
        assert_eq!(kind(&all), "");
    }
}

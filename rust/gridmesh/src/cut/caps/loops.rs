//! The cut line: closed loops and open lines of edges between the two sides.

use rustc_hash::FxHashMap;

use crate::cut::divide::parted::Parted;
use crate::cut::input::Polygons;
use crate::cut::sheet::Sheet;

/// A closed stretch of the cut, as the left piece's faces run along it: in the unrolled surface the model
/// is on its left, if its faces look outward.
#[derive(Clone, Debug)]
pub(in crate::cut) struct Loop {
    /// Each vertex once.
    pub nodes: Vec<u32>,
    /// Where each is on the unrolled line, without jumps, and where the first one is when it comes around.
    pub places: Vec<f64>,
    /// Times that it runs around a closed sheet.
    pub winding: i32,
}

/// All of the cut.
#[derive(Default)]
pub(in crate::cut) struct Loops {
    pub closed: Vec<Loop>,
    /// Lines that end at the mesh's border: their vertices, and where each is on the unrolled line.
    pub open: Vec<(Vec<u32>, Vec<f64>)>,
}

/// Follows the cut's edges, each of which divides a face of the left from one of the right.
pub(in crate::cut) fn trace(faces: Polygons<'_>, parted: &Parted, sheet: &Sheet) -> Loops {
    let mut edges = divided_edges(faces, parted);
    edges.sort_unstable();
    let mut leaving: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
    let mut balance: FxHashMap<u32, i32> = FxHashMap::default();
    for &(a, b) in edges.iter().rev() {
        leaving.entry(a).or_default().push(b);
        *balance.entry(a).or_default() += 1;
        *balance.entry(b).or_default() -= 1;
    }
    let mut loops = Loops::default();
    let mut starts = vec![];
    for (v, _) in edges.iter().copied() {
        let surplus = balance.insert(v, 0).unwrap_or(0);
        starts.extend((0..surplus).map(|_| v));
    }
    starts.extend(edges.iter().map(|e| e.0));
    for start in starts {
        let mut path = vec![start];
        let mut on_path = FxHashMap::default();
        on_path.insert(start, 0);
        while let Some(next) = leaving.get_mut(&path[path.len() - 1]).and_then(Vec::pop) {
            if let Some(&k) = on_path.get(&next) {
                // Around: what comes after the vertex is a loop of its own.
                let around: Vec<u32> = path.drain(k + 1..).collect();
                for v in &around {
                    on_path.remove(v);
                }
                let mut nodes = vec![next];
                nodes.extend(around);
                if nodes.len() > 2 {
                    loops.closed.push(Loop::new(nodes, parted, sheet));
                }
            } else {
                on_path.insert(next, path.len());
                path.push(next);
            }
        }
        if path.len() > 1 {
            let places = places(&path, parted);
            loops.open.push((path, places));
        }
    }
    loops
}

/// Where the vertices of an open line are on the unrolled line.
fn places(path: &[u32], parted: &Parted) -> Vec<f64> {
    let ends = path.windows(2).map(|pair| {
        let (a, b) = (pair[0], pair[1]);
        let [x, y] = parted.cut.get(&(a.min(b), a.max(b))).copied().unwrap_or_default();
        if a < b { [x, y] } else { [y, x] }
    });
    let mut places = vec![];
    for [from, to] in ends {
        if places.is_empty() {
            places.push(from);
        }
        let last = places[places.len() - 1];
        places.push(last + to - from);
    }
    places
}

impl Loop {
    fn new(nodes: Vec<u32>, parted: &Parted, sheet: &Sheet) -> Self {
        let n = nodes.len();
        let ends = |k: usize| {
            let (a, b) = (nodes[k % n], nodes[(k + 1) % n]);
            let [x, y] = parted.cut.get(&(a.min(b), a.max(b))).copied().unwrap_or_default();
            if a < b { [x, y] } else { [y, x] }
        };
        let width = sheet.width();
        let nearest = |place: f64, to: f64| {
            if sheet.closed { place + width * ((to - place) / width).round() } else { place }
        };
        let mut places = vec![ends(0)[0]];
        for k in 0..n {
            let [from, to] = ends(k);
            let next = places[k] + to - from;
            places.push(if k + 1 < n { nearest(ends(k + 1)[0], next) } else { next });
        }
        let winding = if sheet.closed { ((places[n] - places[0]) / width).round() as i32 } else { 0 };
        places[n] = places[0] + width * f64::from(winding);
        Loop { nodes, places, winding }
    }
}

/// Edges of the cut with one face on either side, as the left one runs along them.
fn divided_edges(faces: Polygons<'_>, parted: &Parted) -> Vec<(u32, u32)> {
    let mut found: FxHashMap<(u32, u32), [u32; 3]> = FxHashMap::default();
    let mut see = |a: u32, b: u32, left: bool| {
        let key = (a.min(b), a.max(b));
        if parted.cut.contains_key(&key) {
            let entry = found.entry(key).or_default();
            entry[usize::from(left)] += 1;
            if left {
                entry[2] = a;
            }
        }
    };
    for part in &parted.parts {
        for k in 0..3 {
            see(part.corners[k], part.corners[(k + 1) % 3], part.left);
        }
    }
    let on_cut = parted.on_cut();
    for f in 0..faces.len() {
        if parted.divided[f] {
            continue;
        }
        let corners = faces.face(f);
        for k in 0..corners.len() {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            if on_cut[a as usize] && on_cut[b as usize] {
                see(a, b, parted.left[f]);
            }
        }
    }
    let divides = |(&(a, b), &[right, left, first]): (&(u32, u32), &[u32; 3])| {
        let forward = if first == a { (a, b) } else { (b, a) };
        (right == 1 && left == 1).then_some(forward)
    };
    // Sorted by the caller: the order of the table does not matter.
    found.iter().filter_map(divides).collect()
}

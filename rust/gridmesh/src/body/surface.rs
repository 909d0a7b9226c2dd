//! A mesh in space made from a patch.

use glam::{DVec2, DVec3};

use crate::geometry::metrics::{check_mesh, min_angle, volume};
use crate::options::CellShape;
use crate::patch::{Loop, Patch};

/// A body (or, from [`crate::body::stitch::flat`], a sheet) made from a [`Patch`].
///
/// The drawing lies in the plane z = 0; the front is the side of positive z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Positions in the units of the drawing: the patch's vertices (a body's: those of [`Patch::belted`]) in its numbering, which are the
    /// front, then the back copies of the interior vertices in the same order.
    pub vertices: Vec<DVec3>,
    /// Vertex numbers, counter-clockwise seen from outside: the patch's triangles in its order,
    /// then the back ones in the same order. None if it is of quads.
    pub triangles: Vec<[u32; 3]>,
    /// The same for quads; none if it is of triangles.
    pub quads: Vec<[u32; 4]>,
    /// Vertex numbers of each contour of the patch. Their x and y are the patch's (a body's: those of [`Patch::belted`]) bit
    /// for bit, their z is zero.
    pub silhouette: Vec<Vec<u32>>,
    /// For each of them the turning angle of the drawn corner that it lies on, as in [`Loop::corner`]; 0 elsewhere.
    pub corner: Vec<Vec<f64>>,
    /// Texture coordinates in \[0, 1\], one per corner of each triangle, or of each quad, in
    /// their order.
    ///
    /// Each triangle appears as it lies in the flat patch, at one scale for both directions: the
    /// front as drawn; the back, if they are [`UvLayout::Apart`], beside (or, for wide drawings, below) it
    /// as seen from behind, so that the two islands do not overlap and all triangles are
    /// counter-clockwise; or, if they are [`UvLayout::Shared`], where the front is. Because inflation
    /// keeps angles nearly, there is little distortion.
    pub uv: Vec<DVec2>,
    /// Numbers about it.
    pub report: SurfaceReport,
}

/// Where the back of a body lies in the texture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UvLayout {
    /// Beside the front: each side has a part of the texture of its own.
    #[default]
    Apart,
    /// Where the front is: what is seen on one side is seen on the other too, and shows twice as fine.
    Shared,
}

/// Numbers about a [`Surface`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceReport {
    /// Number of triangles.
    pub triangles: usize,
    /// Number of quads.
    pub quads: usize,
    /// Vertices of valence other than six (of an open sheet's boundary: other than four); of quads other than four
    /// (three).
    pub irregular: usize,
    /// True if every edge joins two triangles wound alike and all vertices are manifold.
    pub watertight: bool,
    /// Number of handles: the drawing's number of holes.
    pub genus: i32,
    /// Enclosed volume; zero for flat surfaces.
    pub volume: f64,
    /// Smallest angle of a triangle, or corner of a quad, in radians.
    pub min_angle: f64,
    /// Pairs of triangles that meet where they should not. The two sheets of a flat pillow lie on
    /// each other by definition; that is not counted.
    pub self_intersections: usize,
    /// True if the zero is proved: the projections of both sides to the drawing plane are
    /// triangulations (exact predicates, also after rounding to `f32` relative to the lattice's
    /// origin) and the front lies above the back. False: the pairs were counted one by one.
    pub embedded: bool,
    /// Moves that were shortened so that no triangle turned over in projection.
    pub shortened: usize,
    /// Fallbacks: vertices that were lifted to a least height, and solves that were repeated with
    /// positive weights because obtuse triangles spoiled the first.
    pub repaired: usize,
    /// Seconds spent in each stage.
    pub seconds: Vec<(&'static str, f64)>,
}

impl Surface {
    /// The patch's triangles at `front`, with a back sheet at `back` (interior vertices only) unless
    /// that is none; topology and measures checked, self-intersections left at zero. `go_on` is asked between these.
    pub(crate) fn assemble<E>(
        patch: &Patch,
        front: Vec<DVec3>,
        back: Option<Vec<DVec3>>,
        layout: UvLayout,
        go_on: impl Fn() -> Result<(), E>,
    ) -> Result<Surface, E> {
        let first = patch.n_boundary() as u32;
        let offset = patch.vertices.len() as u32 - first;
        let closed = back.is_some();
        let mut vertices = front;
        vertices.extend(back.into_iter().flatten());
        let behind = |v: u32| if v < first { v } else { v + offset };
        let is_quads = patch.cells() == CellShape::Quad;
        let (mut triangles, mut quads) = (patch.triangulated().into_owned(), patch.quads.clone());
        if closed {
            triangles.extend_from_within(..);
            let half = triangles.len() / 2;
            triangles[half..].iter_mut().for_each(|t| *t = reversed(t.map(behind)));
            quads.extend(patch.quads.iter().map(|q| reversed(q.map(behind))));
        }
        go_on()?;
        let check = check_mesh(vertices.len(), &triangles);
        go_on()?;
        let report = SurfaceReport {
            triangles: if is_quads { 0 } else { triangles.len() },
            quads: quads.len(),
            irregular: if is_quads {
                irregular(vertices.len(), &quads, closed, first)
            } else {
                check.irregular
            },
            watertight: check.watertight,
            genus: check.genus,
            volume: if closed { volume(&vertices, &triangles) } else { 0.0 },
            min_angle: if is_quads {
                least_corner(&vertices, &quads)
            } else {
                min_angle(&vertices, &triangles)
            },
            ..SurfaceReport::default()
        };
        go_on()?;
        let silhouette = patch.loops.iter().map(|contour| contour.vertices().collect()).collect();
        let corner = patch.loops.iter().map(|contour| contour.corner.clone()).collect();
        let uv = Texture::new(patch, closed, layout).coordinates(patch);
        if is_quads {
            triangles.clear();
        }
        go_on()?;
        Ok(Surface { vertices, triangles, quads, silhouette, corner, uv, report })
    }

    /// The triangles, or each quad cut in two.
    pub(crate) fn triangulated(&self) -> Vec<[u32; 3]> {
        let cut = self.quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        self.triangles.iter().copied().chain(cut).collect()
    }
}

/// The boundary vertices of each loop.
pub(crate) fn contours(patch: &Patch) -> Vec<std::ops::Range<u32>> {
    patch.loops.iter().map(Loop::vertices).collect()
}

/// A face seen from behind: it begins with the same vertex.
fn reversed<const N: usize>(face: [u32; N]) -> [u32; N] {
    std::array::from_fn(|k| face[(N - k) % N])
}

/// Vertices that do not have four quads; on the boundary of an open sheet, below `first`, two.
fn irregular(n_vertices: usize, quads: &[[u32; 4]], closed: bool, first: u32) -> usize {
    let mut count = vec![0u8; n_vertices];
    for &v in quads.iter().flatten() {
        count[v as usize] = count[v as usize].saturating_add(1);
    }
    let regular = |v: u32| if closed || v >= first { 4 } else { 2 };
    (0..).zip(&count).filter(|&(v, &n)| n != regular(v)).count()
}

/// Smallest corner of any quad, in radians.
fn least_corner(vertices: &[DVec3], quads: &[[u32; 4]]) -> f64 {
    let mut least = std::f64::consts::PI;
    for q in quads {
        let p = q.map(|v| vertices[v as usize]);
        for k in 0..4 {
            least = least.min((p[(k + 1) % 4] - p[k]).angle_between(p[(k + 3) % 4] - p[k]));
        }
    }
    if quads.is_empty() { 0.0 } else { least }
}

/// How the flat patch lies in the texture, see [`Surface::uv`].
struct Texture {
    low: DVec2,
    high: DVec2,
    scale: f64,
    /// From the front's part to the back's.
    step: DVec2,
    closed: bool,
    is_apart: bool,
}

impl Texture {
    const MARGIN: f64 = 1.0 / 128.0;

    fn new(patch: &Patch, closed: bool, layout: UvLayout) -> Self {
        let low = patch.vertices.iter().fold(DVec2::INFINITY, |low, &p| low.min(p));
        let high = patch.vertices.iter().fold(DVec2::NEG_INFINITY, |high, &p| high.max(p));
        let size = high - low;
        // The islands stand beside each other along the shorter side of the drawing's box.
        let is_apart = closed && layout == UvLayout::Apart;
        let step = match (is_apart, size.x <= size.y) {
            (false, _) => DVec2::ZERO,
            (true, true) => DVec2::new(0.5, 0.0),
            (true, false) => DVec2::new(0.0, 0.5),
        };
        let room = DVec2::ONE - step - DVec2::splat(2.0 * Self::MARGIN);
        let scale = (room / size).min_element();
        Self { low, high, scale, step, closed, is_apart }
    }

    fn coordinates(&self, patch: &Patch) -> Vec<DVec2> {
        match patch.cells() {
            CellShape::Triangle => self.of(&patch.vertices, &patch.triangles),
            CellShape::Quad => self.of(&patch.vertices, &patch.quads),
        }
    }

    fn of<const N: usize>(&self, vertices: &[DVec2], faces: &[[u32; N]]) -> Vec<DVec2> {
        let (low, high, scale) = (self.low, self.high, self.scale);
        let corner = DVec2::splat(Self::MARGIN);
        let clamp = |p: DVec2| p.clamp(DVec2::ZERO, DVec2::ONE);
        // The front stands above a back that lies below it.
        let lift = DVec2::new(0.0, self.step.y);
        let at = |v: u32| vertices[v as usize];
        let front = |v: u32| clamp(corner + lift + scale * (at(v) - low));
        let side = DVec2::new(self.step.x, 0.0);
        let beside = |v: u32| {
            let p = at(v);
            clamp(corner + side + scale * DVec2::new(high.x - p.x, p.y - low.y))
        };
        let mut uv = Vec::with_capacity(N * faces.len() * (1 + usize::from(self.closed)));
        uv.extend(faces.iter().flatten().map(|&v| front(v)));
        if self.closed {
            let back = faces.iter().flat_map(|&face| reversed(face));
            uv.extend(back.map(|v| if self.is_apart { beside(v) } else { front(v) }));
        }
        uv
    }
}

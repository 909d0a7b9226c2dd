//! A triangle mesh in space made from a patch.

use glam::{DVec2, DVec3};

use crate::metrics::{check_mesh, min_angle, volume};
use crate::patch::{Loop, Patch};

/// A body (or, from [`crate::stitch::flat`], a sheet) made from a [`Patch`].
///
/// The drawing lies in the plane z = 0; the front is the side of positive z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Positions in the units of the drawing: the patch's vertices in its numbering, which are the
    /// front, then the back copies of the interior vertices in the same order.
    pub vertices: Vec<DVec3>,
    /// Vertex numbers, counter-clockwise seen from outside: the patch's triangles in its order,
    /// then the back ones in the same order.
    pub triangles: Vec<[u32; 3]>,
    /// Vertex numbers of each contour of the patch. Their x and y are the patch's bit for bit,
    /// their z is zero.
    pub silhouette: Vec<Vec<u32>>,
    /// Texture coordinates in \[0, 1\], one per corner of each triangle (three per triangle).
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
    /// Vertices of valence other than six (of an open sheet's boundary: other than four).
    pub irregular: usize,
    /// True if every edge joins two triangles wound alike and all vertices are manifold.
    pub watertight: bool,
    /// Number of handles: the drawing's number of holes.
    pub genus: i32,
    /// Enclosed volume; zero for flat surfaces.
    pub volume: f64,
    /// Smallest angle of a triangle, in radians.
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
    /// that is none; topology and measures checked, self-intersections left at zero.
    pub(crate) fn assemble(
        patch: &Patch,
        front: Vec<DVec3>,
        back: Option<Vec<DVec3>>,
        layout: UvLayout,
    ) -> Surface {
        let first = patch.n_boundary() as u32;
        let offset = patch.vertices.len() as u32 - first;
        let closed = back.is_some();
        let mut vertices = front;
        vertices.extend(back.into_iter().flatten());
        let mut triangles = patch.triangles.clone();
        if closed {
            let behind = |v: u32| if v < first { v } else { v + offset };
            triangles.extend(patch.triangles.iter().map(|&[a, b, c]| [behind(a), behind(c), behind(b)]));
        }
        let check = check_mesh(vertices.len(), &triangles);
        let report = SurfaceReport {
            triangles: triangles.len(),
            irregular: check.irregular,
            watertight: check.watertight,
            genus: check.genus,
            volume: if closed { volume(&vertices, &triangles) } else { 0.0 },
            min_angle: min_angle(&vertices, &triangles),
            ..SurfaceReport::default()
        };
        let silhouette = patch.loops.iter().map(|contour| contour.vertices().collect()).collect();
        let uv = texture_coordinates(patch, closed, layout);
        Surface { vertices, triangles, silhouette, uv, report }
    }
}

/// The boundary vertices of each loop.
pub(crate) fn contours(patch: &Patch) -> Vec<std::ops::Range<u32>> {
    patch.loops.iter().map(Loop::vertices).collect()
}

/// See [`Surface::uv`].
fn texture_coordinates(patch: &Patch, closed: bool, layout: UvLayout) -> Vec<DVec2> {
    const MARGIN: f64 = 1.0 / 128.0;
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
    let room = DVec2::ONE - step - DVec2::splat(2.0 * MARGIN);
    let scale = (room / size).min_element();
    let corner = DVec2::splat(MARGIN);
    let clamp = |p: DVec2| p.clamp(DVec2::ZERO, DVec2::ONE);
    // The front stands above a back that lies below it.
    let lift = DVec2::new(0.0, step.y);
    let at = |v: u32| patch.vertices[v as usize];
    let mut uv = Vec::with_capacity(3 * patch.triangles.len() * (1 + usize::from(closed)));
    for t in &patch.triangles {
        uv.extend(t.map(|v| clamp(corner + lift + scale * (at(v) - low))));
    }
    if closed && !is_apart {
        for corners in 0..patch.triangles.len() {
            uv.extend([uv[3 * corners], uv[3 * corners + 2], uv[3 * corners + 1]]);
        }
    } else if closed {
        let side = DVec2::new(step.x, 0.0);
        for &[a, b, c] in &patch.triangles {
            uv.extend([a, c, b].map(|v| {
                let p = at(v);
                clamp(corner + side + scale * DVec2::new(high.x - p.x, p.y - low.y))
            }));
        }
    }
    uv
}

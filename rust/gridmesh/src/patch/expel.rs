//! Mesh vertices that came to lie in a bridged inlet are moved out of it.

use glam::DVec2;

use crate::drawing::curve::bounds;
use crate::error::Result;
use crate::geometry::segments::nearest_on_segment;
use crate::patch::pockets::{Fans, Pockets, depth_in};
use crate::progress::Progress;

/// No triangle is bent below this angle, unless it was so before: 10 degrees.
const LEAST_ANGLE: f64 = 10.0 * std::f64::consts::PI / 180.0;

/// How far beyond the wall of its inlet a vertex may go, in edges.
const BEYOND: [f64; 7] = [0.0, 0.05, 0.1, 0.2, 0.3, 0.45, 0.6];

/// Moves the vertices that lie in inlets to the inside of the nearest walls, to where their triangles
/// are best; one that has no good place there stays.
///
/// `limit` as for [`pockets`](crate::patch::pockets::pockets), `h` the length of an edge. True if any vertex
/// moved.
pub(crate) fn expel(
    pockets: &Pockets,
    vertices: &mut [DVec2],
    fans: &Fans<'_>,
    limit: f64,
    h: f64,
    progress: Progress<'_>,
) -> Result<bool> {
    let boxes: Vec<(DVec2, DVec2)> = pockets.inlets.iter().map(|pocket| bounds(pocket)).collect();
    let mut moved = false;
    for &(v, inlet) in &pockets.inside {
        progress.report(0.0)?;
        let at = vertices[v];
        let cotangent = |p: DVec2| {
            let with = |t: [u32; 3]| sharpness([p, vertices[t[1] as usize], vertices[t[2] as usize]]);
            fans.at(v).map(with).fold(f64::NEG_INFINITY, f64::max)
        };
        let is_out = |p: DVec2| {
            let is_beside = |&(low, high): &(DVec2, DVec2)| p.cmpge(low).all() && p.cmple(high).all();
            let near = pockets.inlets.iter().zip(&boxes).filter(|(_, bounds)| is_beside(bounds));
            near.map(|(pocket, _)| depth_in(pocket, p).unwrap_or(0.0)).all(|depth| depth <= limit)
        };
        let walls = pockets.inlets[inlet]
            .windows(2)
            .map(|wall| wall[0].lerp(wall[1], nearest_on_segment(at, wall[0], wall[1]).0));
        let places = walls.flat_map(|wall| {
            let ahead = (wall - at).normalize_or_zero();
            BEYOND.map(|beyond| wall + beyond * h * ahead)
        });
        let allowed = cotangent(at).max(1.0 / libm::tan(LEAST_ANGLE));
        let mut good: Vec<(f64, DVec2)> = places
            .map(|place| (cotangent(place), place))
            .filter(|&(cotangent, _)| cotangent.is_finite() && cotangent <= allowed)
            .collect();
        good.sort_by(|a, b| a.0.total_cmp(&b.0));
        // The best place that is outside all inlets: asked last, since inlets may have many points.
        if let Some((_, place)) = good.into_iter().find(|&(_, place)| is_out(place)) {
            vertices[v] = place;
            moved = true;
        }
    }
    Ok(moved)
}

/// Cotangent of the least angle of a triangle; infinite if it is not counter-clockwise.
fn sharpness(p: [DVec2; 3]) -> f64 {
    let doubled = (p[1] - p[0]).perp_dot(p[2] - p[0]);
    if doubled <= 0.0 {
        return f64::INFINITY;
    }
    let cotangent = |i: usize| (p[(i + 1) % 3] - p[i]).dot(p[(i + 2) % 3] - p[i]) / doubled;
    cotangent(0).max(cotangent(1)).max(cotangent(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIDDLE: DVec2 = DVec2::new(30.0, 50.0);

    #[test]
    fn a_vertex_leaves_the_inlet_and_its_triangles_stay_in_shape() -> Result<()> {
        let rim: Vec<DVec2> =
            (0..6).map(|i| MIDDLE + DVec2::from_angle(std::f64::consts::FRAC_PI_3 * f64::from(i))).collect();
        let mut vertices = rim.clone();
        vertices.push(MIDDLE);
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [i, (i + 1) % 6, 6]).collect();
        let inlet = vec![rim[1], MIDDLE - DVec2::new(0.0, 0.2), rim[2]];
        let pockets = Pockets { inlets: vec![inlet.clone()], occupied: vec![], inside: vec![(6, 0)] };
        assert!(depth_in(&inlet, vertices[6]).is_some_and(|depth| depth > 0.05));
        assert!(expel(&pockets, &mut vertices, &Fans::new(7, &triangles), 0.05, 1.0, Progress::NONE)?);
        assert!(depth_in(&inlet, vertices[6]).is_none_or(|depth| depth <= 0.05), "{}", vertices[6]);
        for t in triangles {
            assert!(sharpness(t.map(|v| vertices[v as usize])) < 1.0 / LEAST_ANGLE.tan());
        }
        Ok(())
    }

    #[test]
    fn a_vertex_without_a_good_place_stays() -> Result<()> {
        let rim: Vec<DVec2> =
            (0..6).map(|i| MIDDLE + DVec2::from_angle(std::f64::consts::FRAC_PI_3 * f64::from(i))).collect();
        let mut vertices = rim.clone();
        vertices.push(MIDDLE);
        let triangles: Vec<[u32; 3]> = (0..6).map(|i| [i, (i + 1) % 6, 6]).collect();
        let inlet = vec![rim[1], MIDDLE + DVec2::new(2.0, -3.0), MIDDLE - DVec2::new(2.0, 3.0), rim[2]];
        let pockets = Pockets { inlets: vec![inlet], occupied: vec![], inside: vec![(6, 0)] };
        assert!(!expel(&pockets, &mut vertices, &Fans::new(7, &triangles), 0.05, 1.0, Progress::NONE)?);
        assert_eq!(vertices[6], MIDDLE);
        Ok(())
    }
}

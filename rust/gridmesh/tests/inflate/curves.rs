//! The profile reshaped by a curve.

use gridmesh::body::inflate::{InflateOptions, Profile, Side, inflate};
use gridmesh::error::Error;
use gridmesh::progress::Progress;

use crate::shapes::{check_body, disk, drawings, inflated, is_mirrored, polar, seam_ratio, sketched};

/// Curves with a name: they flatten, dent, point and cut in steps.
fn curves() -> Vec<(&'static str, Vec<f64>)> {
    vec![
        ("plateau", vec![0.0, 0.45, 0.75, 0.92, 1.0, 1.0, 1.0]),
        ("ring", vec![0.0, 0.3, 0.6, 0.85, 1.0, 0.8, 0.5]),
        ("pointed", vec![0.0, 0.08, 0.2, 0.35, 0.52, 0.7, 1.0]),
        ("step", vec![0.0, 1e-3, 1e-3, 2.0, 2.0]),
        ("saw", vec![0.0, 1.0, 0.1, 1.0, 0.1, 1.0]),
        ("half", vec![0.0, 0.5]),
    ]
}

/// The interpolant of `InflateOptions::curve`, written anew: cubics with the harmonic means of slopes.
fn curve_at(values: &[f64], t: f64) -> f64 {
    let n = values.len() - 1;
    let rise = |k: usize| values[k + 1] - values[k];
    let slope = |k: usize| {
        if n == 1 {
            return rise(0);
        }
        let (near, far) = match k {
            0 => (rise(0), rise(1)),
            _ if k == n => (rise(n - 1), rise(n - 2)),
            _ if rise(k - 1) * rise(k) <= 0.0 => return 0.0,
            _ => return 2.0 / (1.0 / rise(k - 1) + 1.0 / rise(k)),
        };
        let end = 1.5 * near - 0.5 * far;
        let least = if k == 0 { 0.5 } else { 0.0 };
        near * (end / near).clamp(least, 3.0)
    };
    let k = ((t * n as f64) as usize).min(n - 1);
    let x = t * n as f64 - k as f64;
    if rise(k) == 0.0 {
        return values[k];
    }
    let (h, g) = (x * x * (3.0 - 2.0 * x), x * (1.0 - x));
    values[k] + rise(k) * h + g * ((1.0 - x) * slope(k) - x * slope(k + 1))
}

#[test]
fn a_straight_curve_gives_the_same_bytes() {
    let patch = sketched(&drawings()[2].1, 800);
    let bits = |curve| {
        let body = inflated(&patch, &InflateOptions { curve, ..InflateOptions::default() });
        body.vertices.iter().flat_map(|v| v.to_array()).map(f64::to_bits).collect::<Vec<_>>()
    };
    let plain = bits(None);
    assert_eq!(bits(Some(vec![0.0, 1.0])), plain);
    assert_eq!(bits(Some((0..=7).map(|k| f64::from(k) / 7.0).collect())), plain);
    let ring = &curves()[1].1;
    let bent = bits(Some(ring.clone()));
    assert_ne!(bent, plain);
    assert_eq!(bits(Some(ring.clone())), bent);
}

#[test]
fn a_circle_becomes_the_reshaped_sphere() {
    for patch in [disk(12), disk(30), sketched(&polar(400, |_| 1.0), 3000)] {
        for (name, curve) in curves() {
            for depth in [0.5, 1.0, 2.0] {
                let options =
                    InflateOptions { depth, curve: Some(curve.clone()), ..InflateOptions::default() };
                let body = inflated(&patch, &options);
                assert!(body.report.embedded && is_mirrored(&patch, &body), "{name}");
                for v in &body.vertices[patch.n_boundary()..patch.vertices.len()] {
                    // The walls of a step are so steep that a height means little there; the place does.
                    let wanted = |r: f64| depth * curve_at(&curve, (1.0 - r * r).max(0.0).sqrt());
                    let r = v.truncate().length();
                    let near = [-0.004, 0.0, 0.004].map(|d| wanted((r + d).min(1.0)));
                    let low = near.iter().copied().fold(f64::INFINITY, f64::min);
                    let high = near.iter().copied().fold(0.0, f64::max);
                    assert!(v.z > low - 0.01 * depth && v.z < high + 0.01 * depth, "{name}: {v} {near:?}");
                }
            }
        }
    }
}

#[test]
fn reshaped_bodies_keep_their_promises() {
    for (name, outline) in drawings() {
        let patch = sketched(&outline, 1000);
        for (kind, curve) in curves() {
            for profile in [Profile::Round, Profile::Even, Profile::Flat, Profile::Peak] {
                let curve = Some(curve.clone());
                let options = InflateOptions { profile, curve, ..InflateOptions::default() };
                let body = inflated(&patch, &options);
                check_body(&format!("{name}, {kind}"), &patch, &body);
                assert!(is_mirrored(&patch, &body), "{name}");
            }
        }
    }
}

#[test]
fn reshaped_smooth_outlines_have_no_crease_at_the_silhouette() {
    let (name, outline) = &drawings()[0];
    let patch = sketched(outline, 2000);
    for (kind, curve) in curves().into_iter().take(2) {
        let body = inflated(&patch, &InflateOptions { curve: Some(curve), ..InflateOptions::default() });
        let ratio = seam_ratio(&patch, &body);
        assert!(ratio < 1.4, "{name}, {kind}: {ratio}");
    }
}

#[test]
fn sides_of_reshaped_bodies_have_their_own_depths() {
    let patch = disk(12);
    let curve = curves()[1].1.clone();
    let values = patch.vertices[..patch.n_boundary()].iter().map(|p| 1.0 + 0.5 * p.x).collect::<Vec<_>>();
    let options = InflateOptions {
        front: Some(Side::PerPoint(values)),
        back: Some(Side::Uniform(0.5)),
        curve: Some(curve.clone()),
        ..InflateOptions::default()
    };
    let body = inflated(&patch, &options);
    check_body("tilted ring", &patch, &body);
    let (n, first) = (patch.vertices.len(), patch.n_boundary());
    for v in first..n {
        let (front, back) = (body.vertices[v], body.vertices[v + n - first]);
        let (tilt, plain) = (1.0 + 0.5 * front.x, -back.z / 0.5);
        assert!((front.z / tilt - plain).abs() < 0.02, "{front} {back}");
        let wanted = curve_at(&curve, (1.0 - front.truncate().length_squared()).sqrt());
        assert!((plain - wanted).abs() < 0.02, "{front}: {plain} {wanted}");
    }
}

#[test]
fn curves_that_are_none_are_refused() {
    let patch = disk(3);
    let bad: [&[f64]; 10] = [
        &[],
        &[0.0],
        &[0.1, 1.0],
        &[f64::NAN, 1.0],
        &[0.0, -0.5, 1.0],
        &[0.0, 0.0],
        &[0.0, f64::NAN],
        &[0.0, f64::INFINITY],
        &[0.0, 1e-300, 1.0],
        &[0.0, 1e300],
    ];
    for curve in bad {
        let options = InflateOptions { curve: Some(curve.to_vec()), ..InflateOptions::default() };
        let refused = inflate(&patch, &options, Progress::NONE);
        assert!(matches!(refused, Err(Error::InvalidOption { name: "curve", .. })), "{curve:?}");
    }
    for curve in [vec![0.0, 1e-6], vec![0.0, 1e6], vec![0.0, 1e6, 1e-6]] {
        let body = inflated(&patch, &InflateOptions { curve: Some(curve), ..InflateOptions::default() });
        assert!(body.vertices.iter().all(|v| v.is_finite()));
    }
}

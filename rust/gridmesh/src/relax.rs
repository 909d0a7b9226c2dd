//! Placement of a lattice patch on the drawn curve.
mod band;
pub mod check;
mod contour;
mod energy;
mod sweep;

use glam::DVec2;

pub use check::first_inverted;
pub use contour::{Contour, Rim};

use crate::error::Result;
use crate::progress::Progress;
use band::Band;
use energy::{Barrier, Regularised, Worst};
use sweep::{Active, Slide, det_of, extend, sweep};

#[derive(Clone, Debug)]
pub struct RelaxOptions {
    pub rings: usize,
    pub slide: bool,
    pub stiffness: f64,
    pub tolerance: f64,
    pub laplace: usize,
    pub barrier: usize,
    pub worst: usize,
    pub area: f64,
    pub even: f64,
    pub evens: usize,
    pub worst_tol: f64,
}
impl Default for RelaxOptions {
    fn default() -> Self {
        RelaxOptions {
            rings: 3,
            slide: true,
            stiffness: 0.5,
            tolerance: 0.01,
            laplace: 3,
            barrier: 15,
            worst: 10,
            area: 0.1,
            even: 1.0,
            evens: 5,
            worst_tol: 0.005,
        }
    }
}
#[derive(Clone, Debug, Default)]
pub struct RelaxReport {
    pub inverted: Option<usize>,
    pub start_inverted: usize,
    pub untangle_sweeps: usize,
    pub barrier_sweeps: usize,
    pub worst_sweeps: usize,
    pub seconds: Vec<f64>,
}

pub fn relax(
    triangles: &[[u32; 3]],
    positions: &mut [DVec2],
    contours: &[Contour],
    rims: &mut [Rim],
    options: &RelaxOptions,
    _progress: Progress<'_>,
) -> Result<RelaxReport> {
    let mut report = RelaxReport::default();
    let t0 = std::time::Instant::now();
    let mut slide = Slide::new(contours, rims, options.stiffness, 0.15);
    if options.slide {
        slide.even_out(options.even, options.evens);
    }
    let n_rim = slide.s.len();
    let mut band = match Band::new(triangles, positions, n_rim, options.rings) {
        Ok(b) => b,
        Err(v) => panic!("not a fan {v}"),
    };
    report.seconds.push(t0.elapsed().as_secs_f64());
    let displacement: Vec<DVec2> = (0..n_rim)
        .map(|v| {
            let s = slide.s[v];
            slide.place(v, s) - band.positions[v]
        })
        .collect();
    extend(&mut band, &displacement, options.laplace);
    report.seconds.push(t0.elapsed().as_secs_f64());
    // untangle
    let n = band.n_free;
    for round in 0..200 {
        let mut min = f64::INFINITY;
        let mut bad = 0;
        let mut active = Active::none(n);
        for t in &band.triangles {
            let d = det_of(&band, *t);
            min = min.min(d);
            if d <= 1e-3 {
                bad += 1;
                for &v in t {
                    active.mark(v as usize);
                    if (v as usize) < n {
                        for &w in band.around(v as usize) {
                            active.mark(w as usize);
                            if (w as usize) < n && round > 10 {
                                for &w in band.around(w as usize) {
                                    active.mark(w as usize);
                                }
                            }
                        }
                    }
                }
            }
        }
        if round == 0 {
            report.start_inverted = bad;
        }
        if min > 1e-3 {
            break;
        }
        let eps = (0.04 + min.min(0.0) * min.min(0.0)).sqrt().max(0.05);
        report.untangle_sweeps += 1;
        sweep(&Regularised { eps }, &mut band, &mut slide, options.slide, &mut active, 0.001);
        if round == 199 {
            report.inverted = Some(0);
        }
    }
    report.seconds.push(t0.elapsed().as_secs_f64());
    if report.inverted.is_none() {
        let mut active = Active::all(n);
        for _ in 0..options.barrier {
            report.barrier_sweeps += 1;
            if sweep(&Barrier, &mut band, &mut slide, options.slide, &mut active, options.tolerance) == 0 {
                break;
            }
        }
        report.seconds.push(t0.elapsed().as_secs_f64());
        let mut active = Active::all(n);
        for _ in 0..options.worst {
            report.worst_sweeps += 1;
            if sweep(
                &Worst { area: options.area },
                &mut band,
                &mut slide,
                options.slide,
                &mut active,
                options.worst_tol,
            ) == 0
            {
                break;
            }
        }
        report.seconds.push(t0.elapsed().as_secs_f64());
    }
    for (v, x) in band.global.iter().zip(&band.positions) {
        positions[*v as usize] = *x;
    }
    let mut i = 0;
    for rim in rims.iter_mut() {
        let n = rim.s.len();
        rim.s.copy_from_slice(&slide.s[i..i + n]);
        rim.pinned.copy_from_slice(&slide.pinned[i..i + n]);
        i += n;
    }
    if report.inverted.is_none() {
        report.inverted = first_inverted(positions, triangles, DVec2::ZERO);
    }
    Ok(report)
}

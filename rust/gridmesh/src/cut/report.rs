//! What is told about a cut.

use std::time::Instant;

/// Numbers about a [`super::Cut`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutReport {
    /// Faces that were divided.
    pub cut_faces: usize,
    /// Closed cut lines.
    pub loops: usize,
    /// Cut lines that end at the border of an open mesh; they get no cap.
    pub open_lines: usize,
    /// Closed cut lines without a cap, because they bound no part of the swept surface.
    pub uncapped: usize,
    /// Connected caps of one piece.
    pub caps: usize,
    /// Caps with holes, of those.
    pub rings: usize,
    /// Vertices doubled because a piece would touch itself there.
    pub pinched: usize,
    /// Triangles of the caps of one piece; with quads one for each cap whose lines have an odd number of edges in sum.
    pub cap_triangles: usize,
    /// Quads of the caps of one piece.
    pub cap_quads: usize,
    /// Vertices inside caps.
    pub cap_vertices: usize,
    /// Of those, with a valence other than six, with quads other than four: poles.
    pub cap_irregular: usize,
    /// Smallest angle of a cap's face, in radians; pi without caps.
    pub cap_min_angle: f64,
    /// Mean of twice the inscribed by the circumscribed radius over the triangles of the caps; 1 without them.
    pub cap_radius_ratio: f64,
    /// Caps that bulge less than they should, or not at all, because they would leave the model or repeat one of its edges,
    /// or their line has edges without a length or touches itself.
    pub reduced_caps: usize,
    /// Caps that lie flat though they were to bulge, because they have holes, go around a closed stroke, or end at a plane of symmetry.
    pub flat_caps: usize,
    /// Caps that lie folded on the swept surface, because their line crosses itself there.
    pub folded: usize,
    /// Smallest angle of a face along the cut, caps aside, in radians; pi if there is none.
    pub rim_min_angle: f64,
    /// Largest distance of the rebuilt faces along the cut from the old surface; 0 without `edge_length`.
    pub defect: f64,
    /// Volumes of the pieces, the left one first; those of open pieces mean nothing.
    pub volumes: Vec<f64>,
    /// The input's volume, with its faces divided alike.
    pub volume: f64,
    /// Divisions that were repeated with a finer tolerance, a nudged stroke or half the edge length, and caps made in a simpler
    /// way.
    pub repeated: usize,
    /// Seconds spent in each stage.
    pub seconds: Vec<(&'static str, f64)>,
}

impl CutReport {
    /// Of two cuts, one for each side.
    pub(super) fn add(&mut self, other: &CutReport) {
        self.cut_faces += other.cut_faces;
        self.loops += other.loops;
        self.open_lines += other.open_lines;
        self.uncapped += other.uncapped;
        self.caps += other.caps;
        self.rings += other.rings;
        self.pinched += other.pinched;
        let triangles = self.cap_triangles + other.cap_triangles;
        if triangles > 0 {
            self.cap_radius_ratio = (self.cap_radius_ratio * self.cap_triangles as f64
                + other.cap_radius_ratio * other.cap_triangles as f64)
                / triangles as f64;
        }
        self.cap_triangles += other.cap_triangles;
        self.cap_quads += other.cap_quads;
        self.cap_vertices += other.cap_vertices;
        self.cap_irregular += other.cap_irregular;
        self.cap_min_angle = self.cap_min_angle.min(other.cap_min_angle);
        self.reduced_caps += other.reduced_caps;
        self.flat_caps += other.flat_caps;
        self.folded += other.folded;
        self.rim_min_angle = self.rim_min_angle.min(other.rim_min_angle);
        self.defect = self.defect.max(other.defect);
        self.volumes.extend(&other.volumes);
        self.repeated += other.repeated;
        for &(name, seconds) in &other.seconds {
            match self.seconds.iter_mut().find(|s| s.0 == name) {
                Some(own) => own.1 += seconds,
                None => self.seconds.push((name, seconds)),
            }
        }
    }
}

/// A report in the making.
pub(super) struct Tally {
    pub report: CutReport,
    since: Instant,
}

impl Tally {
    pub fn new() -> Self {
        let report = CutReport {
            cap_min_angle: std::f64::consts::PI,
            rim_min_angle: std::f64::consts::PI,
            cap_radius_ratio: 1.0,
            ..CutReport::default()
        };
        Tally { report, since: Instant::now() }
    }

    /// Ends a stage.
    pub fn stage(&mut self, name: &'static str) {
        let seconds = self.since.elapsed().as_secs_f64();
        self.since = Instant::now();
        match self.report.seconds.iter_mut().find(|s| s.0 == name) {
            Some(own) => own.1 += seconds,
            None => self.report.seconds.push((name, seconds)),
        }
    }
}

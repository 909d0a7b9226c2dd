//! Panels on a page, with the style sheet and the legend.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use crate::svg::ink::Ink;
use crate::svg::picture::Picture;

/// An SVG file of panels in rows of `columns`. Below is a legend of those of the given inks that the
/// panels use.
pub fn page(panels: &[Picture], columns: usize, legend: &[(Ink, &str)]) -> String {
    const MARGIN: f64 = 16.0;
    const TITLE: f64 = 20.0;
    const LINE: f64 = 18.0;
    let columns = columns.clamp(1, panels.len().max(1));
    let widest = panels.iter().map(|panel| panel.width).fold(0.0, f64::max);
    let rows: Vec<&[Picture]> = panels.chunks(columns).collect();
    let width = MARGIN + columns as f64 * (widest + MARGIN);
    let mut body = String::new();
    let mut top = MARGIN;
    for row in &rows {
        let tallest = row.iter().map(|panel| panel.height).fold(0.0, f64::max);
        let titles = if row.iter().any(|panel| !panel.title.is_empty()) { TITLE } else { 0.0 };
        let captions = if row.iter().any(|panel| !panel.caption.is_empty()) { LINE } else { 0.0 };
        for (k, panel) in row.iter().enumerate() {
            let left = MARGIN + k as f64 * (widest + MARGIN);
            let middle = left + 0.5 * widest;
            let (x, y) = (middle - 0.5 * panel.width, top + titles + 0.5 * (tallest - panel.height));
            let _ = writeln!(body, r#"<g transform="translate({x:.1} {y:.1})">"#);
            body.push_str(&panel.body);
            body.push_str("</g>\n");
            text(&mut body, "h", middle, top + 12.0, &panel.title);
            text(&mut body, "n", middle, top + titles + tallest + 14.0, &panel.caption);
        }
        top += titles + tallest + captions + MARGIN;
    }
    let mut left = MARGIN;
    let used: BTreeSet<Ink> = panels.iter().flat_map(|panel| panel.used.iter().copied()).collect();
    let legend: Vec<_> = legend.iter().filter(|(ink, _)| used.contains(ink)).collect();
    for (ink, what) in &legend {
        let needed = 38.0 + 6.4 * what.chars().count() as f64;
        if left + needed > width && left > MARGIN {
            (left, top) = (MARGIN, top + LINE);
        }
        let y = top + 2.0;
        let class = ink.class();
        let _ = if ink.is_face() {
            writeln!(body, r#"<path class="{class}" d="M{left:.1} {:.1}h14v10h-14z"/>"#, y - 5.0)
        } else if ink.is_dot() {
            writeln!(body, r#"<path class="{class}" d="M{:.1} {y:.1}h0"/>"#, left + 7.0)
        } else {
            writeln!(body, r#"<path class="{class}" d="M{left:.1} {y:.1}h14"/>"#)
        };
        text(&mut body, "g", left + 22.0, y + 4.0, what);
        left += needed;
    }
    let height = if legend.is_empty() { top } else { top + LINE };
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\">\n\
         {}<rect width=\"100%\" height=\"100%\" rx=\"8\" class=\"paper\"/>\n{body}</svg>\n",
        style(&used)
    )
}

fn text(body: &mut String, class: &str, x: f64, y: f64, words: &str) {
    if !words.is_empty() {
        let words = words.replace('&', "&amp;").replace('<', "&lt;");
        let _ = writeln!(body, r#"<text class="{class}" x="{x:.1}" y="{y:.1}">{words}</text>"#);
    }
}

/// The style sheet: colours for light paper, and for dark where the reader asks for it.
fn style(used: &BTreeSet<Ink>) -> String {
    let mut css = String::from(
        "path{stroke-linejoin:round;stroke-linecap:round;fill:none}\
         text{font:12px system-ui,\"Helvetica Neue\",Arial,sans-serif;fill:#1f2933}\
         .h{font-weight:600;font-size:13px}.h,.n{text-anchor:middle}.n{fill:#52606d}\
         .paper{fill:#fff}.o{stroke:#2b3644;stroke-width:.35}",
    );
    let mut dark = String::from("text{fill:#e6edf3}.n{fill:#9fb0c0}.paper{fill:#11161d}");
    for &ink in used {
        let (class, width, light, night) = ink.style();
        if ink.is_face() {
            let _ = write!(css, ".{class}{{fill:{light};fill-rule:evenodd}}");
            let _ = write!(dark, ".{class}{{fill:{night}}}");
        } else {
            let _ = write!(css, ".{class}{{stroke:{light};stroke-width:{width}}}");
            let _ = write!(dark, ".{class}{{stroke:{night}}}");
        }
    }
    format!("<style>{css}@media (prefers-color-scheme:dark){{{dark}}}</style>\n")
}

//! The fuzz targets (`rust/fuzz`) on a fixed number of pseudorandom inputs, and on what fuzzing found.
//!
//! `GRIDMESH_FUZZ_RUNS` is the number of inputs for each target, `GRIDMESH_FUZZ_SEED` the first one's number.

#![expect(clippy::panic, clippy::unwrap_used, reason = "in a function that the tests share")]

#[path = "../../fuzz/src/lib.rs"]
mod targets;

/// Pseudorandom bytes (SplitMix64), of a length that varies.
fn bytes(seed: u64) -> Vec<u8> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    };
    let n = next() % 400;
    (0..n).map(|_| next() as u8).collect()
}

fn run(target: fn(&[u8]), runs: u64) {
    let number = |name, default| std::env::var(name).map_or(default, |text| text.parse().unwrap());
    let (first, runs) = (number("GRIDMESH_FUZZ_SEED", 0), number("GRIDMESH_FUZZ_RUNS", runs));
    for seed in first..first + runs {
        let data = bytes(seed);
        if std::panic::catch_unwind(|| target(&data)).is_err() {
            panic!("seed {seed}, {} bytes", data.len());
        }
    }
}

#[test]
fn sketches_keep_their_promises() {
    run(targets::sketch, 400);
}

#[test]
fn fills_keep_their_promises() {
    run(targets::fill, 1500);
}

#[test]
fn regrids_keep_their_promises() {
    run(targets::regrid, 1500);
}

#[test]
fn cuts_keep_their_promises() {
    run(targets::cut, 1500);
}

#[test]
fn combined_drawings_keep_their_promises() {
    run(targets::combine, 3000);
}

#[test]
fn bent_lattices_keep_their_promises() {
    run(targets::bent, 300);
}

/// Some filled the memory: around a vertex of their first surface, which repeated an edge, no walk ended.
#[test]
fn several_loops_whose_first_surface_repeats_an_edge_are_refused() {
    targets::several(&bytes(8923));
}

#[test]
fn fills_of_several_loops_keep_their_promises() {
    run(targets::several, 1500);
}

#[test]
fn fills_with_quads_keep_their_promises() {
    run(targets::quads, 600);
}

#[test]
fn joins_keep_their_promises() {
    run(targets::join, 300);
}

#[test]
fn pictures_keep_their_promises() {
    run(targets::picture, 1500);
}

#[test]
fn meshes_of_pictures_keep_their_promises() {
    run(targets::cutout, 200);
}

/// A third triangle at an edge inside the region.
#[test]
fn what_hangs_on_a_region_keeps_its_edges_open() {
    targets::regrid(&[
        10, 251, 255, 232, 93, 232, 232, 247, 255, 255, 255, 191, 255, 78, 255, 255, 255, 255, 255, 36, 255,
        255, 255, 255, 255, 255, 255, 255, 255, 127, 255, 255, 255, 93, 255, 255, 8, 10, 1, 7, 170, 170, 170,
        255, 247, 255, 255, 255, 191, 255, 78, 255, 1, 0, 0, 3, 36, 255, 255, 255, 255, 255, 255, 255, 255,
        255, 127, 255, 255, 255, 93, 170, 170, 232, 232, 251, 55, 255, 255, 255, 232,
    ]);
}

/// A place around the axis of a tube that rounding put before the first vertex of a loop.
#[test]
fn a_vertex_at_the_seam_of_a_tube_is_found() {
    targets::several(&[205, 17, 85, 31, 82, 66, 100, 3, 249, 27, 108, 238, 67, 82, 100, 88, 0, 40, 75]);
}

/// It is 5e-315 wide as the line is seen: places of the line, counted in its cells, are not finite.
#[test]
fn a_mesh_that_is_seen_as_hardly_a_point_is_not_cut() {
    targets::cut(&[
        9, 193, 200, 200, 200, 136, 200, 200, 200, 136, 9, 106, 200, 161, 33, 200, 129, 200, 200, 136, 1,
        136, 161, 255, 32, 255, 44, 200, 196,
    ]);
}

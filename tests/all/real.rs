//! Real meshes, where the collection lies beside the repository.

use std::io::Write;
use std::path::{Path, PathBuf};

use cones::uv::overlaps;
use cones::{ConeChoice, FreeSeams, Islands, Options, unwrap_model};
use tests::oracle::check_map;

/// The test below.
const NAME: &str = "real_meshes_unwrap_to_a_disk_without_flips_and_with_matching_seams";

/// The collection of meshes, which is not part of the repository; a line says so where it is not there.
fn collection() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/meshes");
    let found = folder.is_dir();
    if !found {
        // Past what the harness holds back from tests that pass.
        let line = format!("skipped: real::{NAME}: {} is missing\n", folder.display());
        std::io::stderr().write_all(line.as_bytes()).expect("there is somewhere to say it");
    }
    found.then_some(folder)
}

/// Small meshes in one piece with the number of cones that they are unwrapped with.
const MESHES: [(&str, usize); 14] = [
    ("hemisphere_2051.obj", 8),
    ("spot_2930.obj", 8),
    ("punctured_torus_4599.obj", 8),
    ("table1/fandisk_6475.obj", 8),
    ("table1/octaflower_7994.obj", 8),
    ("table1/moai_10002.obj", 8),
    ("table1/planck_open_10064.obj", 8),
    ("rocker_arm_10044.obj", 8),
    ("camelhead_11381.off", 8),
    ("face_17157.obj", 8),
    ("beetle_19887.off", 8),
    ("threeholes_3596.off", 16),
    ("fertility_4494.off", 16),
    ("casting_5096.obj", 24),
];

#[test]
fn real_meshes_unwrap_to_a_disk_without_flips_and_with_matching_seams() {
    let Some(folder) = collection() else { return };
    for (name, count) in MESHES {
        let path = folder.join(name);
        assert!(path.is_file(), "the collection is at hand, but {name} is missing in it");
        let model = geom::io::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let (cones, islands) = (ConeChoice::Count(count), Islands::Single);
        let options = Options { cones, islands, free_seams: FreeSeams::Never, ..Options::default() };
        let atlas = unwrap_model(&model, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
        let found = check_map(&model, &atlas);
        assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{name}: {:?}", atlas.notes);
        assert_eq!(found.euler, [1], "{name}: one island, a disk");
        assert!(found.seam_mismatch < 1e-6 && found.curvature < 1e-5, "{name}: {found:?}");
        let options = Options { islands: Islands::OverlapFree, free_seams: FreeSeams::Auto, ..options };
        let atlas = unwrap_model(&model, &options).unwrap_or_else(|error| panic!("{name}: {error}"));
        let found = check_map(&model, &atlas);
        assert_eq!((found.flipped, found.degenerate, found.torn), (0, 0, 0), "{name}: {:?}", atlas.notes);
        assert!(found.euler.iter().all(|&euler| euler == 1), "{name}: {} islands, disks", found.euler.len());
        let images: Vec<_> = atlas.triangles.corners.iter().map(|t| t.map(|c| atlas.uv[c as usize])).collect();
        assert!(overlaps(&images).pairs.is_empty(), "{name}");
    }
}

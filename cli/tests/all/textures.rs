//! Maps of several textures, and what becomes of textures with another map.

use crate::folder::{Folder, stderr, stdout};
use serde_json::Value;

/// Two squares far from each other, each on the whole of its texture.
pub(crate) const TWO: &str = "mtllib two.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\nv 5 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl red\nf 1/1 2/2 3/3 4/4\nusemtl blue\nf 5/1 6/2 7/3 8/4\n";

/// The materials of it, with what each says besides its name.
pub(crate) fn materials(red: &str, blue: &str) -> String {
    format!("newmtl red\nKd 1 0 0\n{red}\nnewmtl blue\nKd 0 0 1\n{blue}\n")
}

/// A folder with two squares on two textures.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("two.obj", TWO);
    folder.write("two.mtl", &materials("map_Kd red.png", "map_Kd blue.png"));
    folder
}

fn printed(folder: &Folder, args: &[&str]) -> Value {
    serde_json::from_str(&stdout(&folder.run(args).success())).expect("it is JSON")
}

#[test]
fn what_lies_on_another_texture_does_not_overlap() {
    let folder = folder();
    let pairs = || printed(&folder, &["measure", "two.obj", "--json"])["distortion"]["overlap_pairs"].clone();
    assert_eq!(pairs(), 0);
    let textures = printed(&folder, &["measure", "two.obj", "--json"])["textures"].clone();
    let of = |name: &str| serde_json::json!({"name": name, "faces": 1, "fill": 1.0});
    assert_eq!(textures, serde_json::json!([of("red.png"), of("blue.png")]));
    let text = stdout(&folder.run(&["measure", "two.obj"]).success());
    assert!(text.contains("100.0 % of red.png, 100.0 % of blue.png") && text.contains("none overlapping"), "{text}");
    // One picture for both, or colours alone, are one square.
    for (red, blue) in [("map_Kd red.png", "map_Kd red.png"), ("", "")] {
        folder.write("two.mtl", &materials(red, blue));
        assert_eq!(pairs(), 2, "{red}");
    }
    // Of a library that is not there each material may have its own.
    std::fs::remove_file(folder.path("two.mtl")).expect("it is there");
    assert_eq!(pairs(), 0);
}

#[test]
fn a_map_that_overlaps_on_no_texture_is_left_and_packing_says_that_textures_become_one() {
    let folder = folder();
    let left = folder.run(&["islands", "two.obj", "-o", "left.obj"]).success();
    assert!(stdout(&left).contains("nothing overlaps") && stderr(&left).is_empty(), "{}", stderr(&left));
    let uv = |name: &str| geom::io::read(folder.path(name)).unwrap().uv().unwrap().all();
    assert_eq!(uv("left.obj"), uv("two.obj"));
    let packed = folder.run(&["pack", "two.obj", "-o", "new.obj"]).success();
    let told = "warning: 2 textures become one square, which none of them fits: cones bake two.obj new.obj -o new.baked.obj makes one that does\n";
    assert_eq!(stderr(&packed), told);
    assert!(stdout(&packed).contains("100.0 % before"), "{}", stdout(&packed));
    // Two triangles of one texture over each other are taken apart, and all is one square.
    folder.write("over.obj", &format!("{TWO}v 9 0 0\nv 10 0 0\nv 9 1 0\nf 9/1 10/2 11/4\n"));
    let apart = folder.run(&["islands", "over.obj", "-o", "apart.obj"]).success();
    assert!(stderr(&apart).contains("2 textures become one square"), "{}", stderr(&apart));
    for name in ["new.obj", "apart.obj"] {
        folder.write("bare.obj", &folder.read(name).replace("mtllib", "# mtllib"));
        assert_eq!(printed(&folder, &["measure", "bare.obj", "--json"])["distortion"]["overlap_pairs"], 0, "{name}");
    }
    let tiles = ["pack", "two.obj", "-o", "tiles.obj", "--udim", "--texel-density", "900"];
    assert!(stderr(&folder.run(&tiles).success()).contains("2 textures become one set of tiles"));
}

#[test]
fn textures_of_the_old_map_are_told_of() {
    let folder = folder();
    let said = |args: &[&str]| stderr(&folder.run(args).success());
    let told = "red.png and blue.png were made for the old map and do not fit the new one: cones bake two.obj";
    let new = said(&["unwrap", "two.obj", "-o", "new.obj"]);
    assert!(new.contains(&format!("{told} new.obj -o new.baked.obj makes one that does")), "{new}");
    assert!(!said(&["unwrap", "two.obj", "-o", "new.obj", "--checker"]).contains("texture"));
    assert!(said(&["unwrap", "two.obj", "--out-dir", "maps"]).contains(told));
    folder.write("two.mtl", &materials("", ""));
    for command in ["unwrap", "pack"] {
        assert!(!said(&[command, "two.obj", "-o", "new.obj"]).contains("texture"), "{command}");
    }
    folder.write(
        "one.ply",
        "ply\nformat ascii 1.0\ncomment TextureFile one.png\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         property float s\nproperty float t\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
         0 0 0 0 0\n1 0 0 0.1 0\n0 1 0 0 0.1\n3 0 1 2\n",
    );
    let ply = said(&["pack", "one.ply", "-o", "new.ply"]);
    assert!(
        ply.contains("one.png was made for the old map and does not fit") && ply.contains("cones bake one.ply new.ply"),
        "{ply}"
    );
}

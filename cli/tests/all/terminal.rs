//! What a user of a terminal expects: how much is said, how wide it is, help, completions, manual pages.

use crate::folder::{Folder, stderr, stdout};

const SUBCOMMANDS: [&str; 17] = [
    "unwrap",
    "extract",
    "compare",
    "figure",
    "measure",
    "islands",
    "pack",
    "persistence",
    "tree",
    "simplify",
    "distance",
    "features",
    "view",
    "shape",
    "demo",
    "completions",
    "man",
];

fn assert_fits(text: &str, what: &str) {
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{what}: {} columns in {line:?}", line.chars().count());
    }
}

#[test]
fn help_lists_each_option_below_its_heading() {
    let folder = Folder::new();
    let help = stdout(&folder.run(&["unwrap", "-h"]).success());
    let mut heading = "";
    let mut below = Vec::new();
    for line in help.lines() {
        if line.ends_with(':') && !line.starts_with(' ') {
            heading = line.trim_end_matches(':');
        }
        let option = line.split_whitespace().find(|word| word.starts_with('-'));
        if let (true, Some(option)) = (line.starts_with("  ") && line.trim_start().starts_with('-'), option) {
            below.push((option.trim_end_matches(','), heading));
        }
    }
    for (option, heading) in [
        ("-o", "Options"),
        ("-n", "Cones"),
        ("--cones", "Cones"),
        ("--seams", "Seams"),
        ("--margin", "Islands"),
        ("--vtp", "Pictures"),
        ("--jobs", "Many surfaces"),
        ("--threads", "For all commands"),
    ] {
        assert!(below.contains(&(option, heading)), "{option} is not below {heading}: {below:?}");
    }
}

#[test]
fn every_help_fits_80_columns() {
    let folder = Folder::new();
    for option in ["-h", "--help"] {
        assert_fits(&stdout(&folder.run(&[option]).success()), option);
        for subcommand in SUBCOMMANDS {
            assert_fits(&stdout(&folder.run(&[subcommand, option]).success()), subcommand);
        }
    }
}

#[test]
fn every_table_fits_80_columns_with_wide_numbers() {
    let folder = Folder::new();
    // Far out and turned, so that coordinates have signs and many digits; vertices from a million on.
    folder.run(&["shape", "hare", "--vertices", "600", "-o", "hare.obj"]).success();
    let mut text = "v 0 0 0\n".repeat(1_000_000);
    for line in folder.read("hare.obj").lines() {
        if let Some(point) = line.strip_prefix("v ") {
            let point: Vec<f64> = point.split_whitespace().map(|x| x.parse().expect("a number")).collect();
            text += &format!("v {} {} {}\n", -1234.5 * point[0], 1e-9 * point[1] - 98765.4, -12345.6 + 1e3 * point[2]);
        } else if let Some(face) = line.strip_prefix("f ") {
            let face: Vec<u64> = face.split_whitespace().map(|c| c.parse().expect("an index")).collect();
            text += &format!("f {} {} {}\n", face[0] + 1_000_000, face[1] + 1_000_000, face[2] + 1_000_000);
        }
    }
    folder.write("wide.obj", &text);
    let says = |args: &[&str]| stdout(&folder.run(args).success());
    for method in ["refined", "persistence"] {
        assert_fits(&says(&["extract", "wide.obj", "-n", "12", "--method", method]), "extract");
    }
    assert_fits(&says(&["persistence", "hare.obj", "--field", "phi"]), "persistence");
    assert_fits(&says(&["features", "wide.obj"]), "features");
    folder.run(&["unwrap", "wide.obj", "-n", "4", "-o", "out.obj"]).success();
    assert_fits(&says(&["measure", "out.obj"]), "measure");
}

#[test]
fn comparisons_fit_80_columns() {
    let folder = Folder::with_shapes();
    let methods = "alternating+smooth+harmonic+linear,persistence,lscm";
    let text = stdout(
        &folder
            .run(&["compare", "hare.obj", "sphere.obj", "-n", "1,6", "--best-of", "1", "--method", methods])
            .success(),
    );
    assert_fits(&text, "compare");
    for told in ["alternating+smooth+harmonic+linear", "hare.obj: ", "1 cone asked for", "qc: "] {
        assert!(text.contains(told), "{told}: {text}");
    }
}

#[test]
fn quiet_says_results_and_errors_alone_and_verbose_says_stages() {
    let folder = Folder::with_shapes();
    // A sphere needs three, which is warned of.
    let run = |options: &[&str]| {
        folder.run(&[options, &["unwrap", "sphere.obj", "-n", "1", "-o", "out.obj"]].concat()).success()
    };
    let quiet = run(&["--quiet"]);
    assert_eq!((stdout(&quiet), stderr(&quiet)), (String::new(), String::new()));
    assert!(stderr(&run(&[])).starts_with("warning: "));
    let verbose = stderr(&run(&["--verbose"]));
    for stage in ["read", "prepare", "factor", "hierarchy", "cut", "scale", "layout", "measure", "write"] {
        assert!(verbose.contains(&format!("sphere.obj: {stage} (")), "{stage}: {verbose}");
    }
    assert!(!stdout(&folder.run(&["extract", "-q", "hare.obj", "-n", "6"]).success()).is_empty());
    assert!(folder.complaint(&["-q", "extract", "missing.obj"]).contains("missing.obj"));
    folder.run(&["-q", "-v", "demo"]).code(2);
}

#[test]
fn a_wrong_number_is_answered_with_what_is_expected() {
    let folder = Folder::new();
    for (args, expected) in [
        ("unwrap a.obj -o b.obj -n 1.5", "'1.5' for '-n <N>': expected a whole number of cones, at least 0"),
        ("unwrap a.obj -o b.obj -n -3", "'-3' for '-n <N>': expected a whole number of cones, at least 0"),
        ("unwrap a.obj -o b.obj --margin -1", "'-1' for '--margin <TEXELS>': expected a number, at least 0"),
        ("unwrap a.obj -o b.obj --seam-weight -0.5", "expected a number from 0 to 1"),
        ("unwrap a.obj -o b.obj --max-distortion -2", "expected a number above 1"),
        ("unwrap a.obj -o b.obj --texture-size 0", "expected a whole number of texels, at least 1"),
        ("unwrap a.obj --out-dir d --jobs 0", "expected a whole number of surfaces, at least 1"),
        ("demo --threads 0", "'0' for '--threads <T>': expected a whole number of threads from 1 to 1024"),
        ("demo --threads 4000", "expected a whole number of threads from 1 to 1024"),
        ("demo --threads -1", "expected a whole number of threads from 1 to 1024"),
        ("compare -n 4,-8", "'-8' for '-n <N,…>': expected a whole number of cones from 0 to 64"),
        ("features a.obj -n -1", "expected a whole number of feature points, at least 0"),
        ("persistence a.npy --top 2.5", "expected a whole number of pairs, at least 0"),
        ("distance a.npy b.npy --order -1", "expected a number, at least 1"),
        ("view a.obj --port 70000", "expected a whole number from 0 to 65535"),
    ] {
        let words: Vec<&str> = args.split(' ').collect();
        let said = stderr(&folder.run(&words).code(2));
        assert!(said.contains(expected) && !said.contains("tip"), "{args}: {said}");
    }
}

#[test]
fn shells_complete_the_command_and_man_has_its_pages() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = stdout(&folder.run(&["completions", shell]).success());
        assert!(script.contains("max-distortion"), "{shell}");
    }
    folder.run(&["completions", "abacus"]).code(2);
    let page = stdout(&folder.run(&["man"]).success());
    assert!(page.contains(".TH") && page.contains("unwrap"), "{page}");
    assert!(stdout(&folder.run(&["man", "unwrap"]).success()).contains("max\\-distortion"));
    assert!(folder.complaint(&["man", "statue"]).contains("no subcommand statue"));
}

#[test]
fn examples_are_in_help_and_manual_and_options_have_their_values() {
    let folder = Folder::new();
    for subcommand in ["unwrap", "measure", "pack", "islands", "features", "persistence", "view"] {
        let example = format!("cones {subcommand} ");
        for option in ["-h", "--help"] {
            let help = stdout(&folder.run(&[subcommand, option]).success());
            let (_, examples) = help.split_once("\nExamples:\n").unwrap_or_else(|| panic!("{subcommand}: {help}"));
            assert!(examples.contains(&example), "{subcommand}: {examples}");
        }
        let page = stdout(&folder.run(&["man", subcommand]).success());
        let (_, examples) = page.split_once(".SH EXAMPLES\n").unwrap_or_else(|| panic!("{subcommand}: {page}"));
        assert!(examples.contains(&example), "{subcommand}: {examples}");
        let (_, synopsis) = page.split_once(".SH SYNOPSIS\n").expect("there is one");
        let (synopsis, _) = synopsis.split_once(".SH").expect("more follows");
        assert!(synopsis.contains(&example) && !synopsis.contains(" ]"), "{subcommand}: {synopsis}");
    }
}

#[test]
fn one_of_a_thing_is_told_in_the_singular() {
    let folder = Folder::new();
    folder.write("one.txt", "7\n");
    let said = stdout(&folder.run(&["persistence", "one.txt"]).success());
    assert!(said.starts_with("one.txt: series of 1 position\n"), "{said}");
    let said = stdout(&folder.run(&["tree", "one.txt"]).success());
    assert!(said.contains("tree of 1 leaf, 0 saddles, 1 root"), "{said}");
    folder.write("triangle.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let said = stdout(&folder.run(&["unwrap", "triangle.obj", "-o", "out.obj"]).success());
    assert!(said.contains("3 vertices, 1 triangle, ") && said.contains("1 island,"), "{said}");
    assert!(stdout(&folder.run(&["measure", "out.obj"]).success()).starts_with("surface   3 vertices, 1 face\n"));
    folder.write("point.obj", "v 0 0 0\n");
    assert!(folder.complaint(&["unwrap", "point.obj", "-o", "x.obj"]).contains("there is 1 vertex but no faces"));
}

#[test]
fn extracting_offers_only_what_it_does() {
    let folder = Folder::with_shapes();
    let help = stdout(&folder.run(&["extract", "--help"]).success());
    for option in ["--cones <", "--scale", "--triangulate", "--picture", "--layout"] {
        assert!(!help.contains(option), "{option}");
    }
    folder.run(&["extract", "hare.obj", "--cones", "cones.txt"]).code(2);
}

//! What once broke the command: limits of the system, names of any length, outputs that are no plain files.

use crate::folder::{Folder, PROGRAM, stderr, stdout};
use std::fs;
use std::path::Path;

#[test]
fn a_name_of_any_length_is_told_in_a_table_that_fits() {
    let folder = Folder::new();
    folder.write("x.nodes.csv", &format!("id,name,value\n0,{},1\n1,\"two\nlines\",2\n2,c,0\n", "x".repeat(70_000)));
    folder.write("x.edges.csv", "a,b\n0,1\n1,2\n");
    let table = stdout(&folder.run(&["persistence", "x.nodes.csv"]).success());
    assert!(table.contains("xxx…") && table.contains("two lines"), "{table}");
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    folder.run(&["persistence", "x.nodes.csv", "--pairs", "pairs.csv"]).success();
    assert!(folder.read("pairs.csv").contains(&"x".repeat(70_000)), "files have it all");
}

#[test]
fn output_names_may_be_as_long_as_the_file_system_takes_them() {
    let folder = Folder::new();
    for length in [200, 243, 244, 250, 255] {
        let name = format!("{}.obj", "n".repeat(length - 4));
        if fs::write(folder.path(&name), "").is_err() {
            println!("skipped: the file system has no names of {length} bytes");
            continue;
        }
        folder.run(&["shape", "sphere", "--vertices", "50", "-o", &name]).success();
        assert!(folder.read(&name).starts_with('#') || folder.read(&name).starts_with('v'));
    }
    let complaint = folder.complaint(&["unwrap", "missing.obj", "-o", &format!("{}.obj", "n".repeat(300))]);
    assert!(complaint.contains("cannot be written"), "it is known before the input is read: {complaint}");
}

#[test]
fn a_picture_that_claims_gigabytes_in_kilobytes_is_refused() {
    let folder = Folder::new();
    let side = 20_000;
    let file = fs::File::create(folder.path("bomb.png")).expect("it can be made");
    let mut encoder = png::Encoder::new(file, side, side);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("it can be written");
    writer.write_image_data(&vec![0; (side / 8 * side) as usize]).expect("it can be written");
    writer.finish().expect("it can be written");
    let complaint = folder.complaint(&["persistence", "bomb.png"]);
    assert!(complaint.contains("claims 400000000 pixels"), "{complaint}");
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};
    use std::process::{Child, Command, Output, Stdio};
    use std::thread::sleep;
    use std::time::{Duration, Instant};

    /// Runs the command by a shell that has done something before.
    fn shell(folder: &Folder, before: &str, args: &str) -> Output {
        let script = format!("{before}\nexec \"$0\" {args}");
        Command::new("sh").args(["-c", &script, PROGRAM]).current_dir(folder.root()).output().expect("there is a shell")
    }

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).expect("it is there").permissions().mode() & 0o777
    }

    /// Names of unfinished files in a folder.
    fn unfinished(folder: &Folder) -> Vec<String> {
        folder.names().into_iter().filter(|name| name.starts_with('.')).collect()
    }

    #[test]
    fn a_file_that_is_replaced_hands_on_its_mode_and_a_new_one_follows_the_mask() {
        let folder = Folder::new();
        for wanted in [0o600, 0o640, 0o666] {
            folder.write("out.obj", "old");
            fs::set_permissions(folder.path("out.obj"), fs::Permissions::from_mode(wanted)).expect("it is ours");
            folder.run(&["shape", "sphere", "--vertices", "50", "-o", "out.obj"]).success();
            assert_eq!(mode(&folder.path("out.obj")), wanted);
        }
        for (mask, wanted) in [("022", 0o644), ("077", 0o600)] {
            let done = shell(&folder, &format!("umask {mask}"), &format!("shape sphere --vertices 50 -o {mask}.obj"));
            assert!(done.status.success());
            assert_eq!(mode(&folder.path(&format!("{mask}.obj"))), wanted);
        }
    }

    #[test]
    fn a_link_stays_and_what_it_leads_to_is_written() {
        let folder = Folder::new();
        fs::create_dir(folder.path("there")).expect("a folder can be made");
        folder.write("there/old.obj", "old");
        for target in ["there/old.obj", "there/new.obj"] {
            let _ = fs::remove_file(folder.path("link.obj"));
            symlink(target, folder.path("link.obj")).expect("links can be made");
            folder.run(&["shape", "sphere", "--vertices", "50", "-o", "link.obj"]).success();
            assert!(fs::symlink_metadata(folder.path("link.obj")).expect("it is there").is_symlink());
            assert!(fs::metadata(folder.path(target)).expect("it was written").len() > 1000, "{target}");
        }
    }

    #[test]
    fn devices_and_pipes_are_written_to() {
        let folder = Folder::with_shapes();
        folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "/dev/null", "--report", "/dev/null"]).success();
        let done = folder.run(&["shape", "sphere", "--vertices", "50", "-o", "/dev/stdout"]).success();
        folder.run(&["shape", "sphere", "--vertices", "50", "-o", "plain.obj"]).success();
        assert_eq!(stdout(&done), folder.read("plain.obj"), "the file alone, and no summary");
        assert!(stderr(&done).contains("written to /dev/stdout"), "{}", stderr(&done));
        // Where standard output is a file, it is written from where it stands.
        let appended = shell(&folder, "exec > all.obj; echo '# before'", "shape sphere --vertices 50 -o /dev/stdout");
        assert!(appended.status.success());
        assert_eq!(folder.read("all.obj"), format!("# before\n{}", folder.read("plain.obj")));
        assert!(Command::new("mkfifo").arg(folder.path("pipe.obj")).status().expect("there is a mkfifo").success());
        let reader =
            Command::new("cat").arg(folder.path("pipe.obj")).stdout(Stdio::piped()).spawn().expect("it starts");
        folder.run(&["shape", "sphere", "--vertices", "50", "-o", "pipe.obj"]).success();
        let read = reader.wait_with_output().expect("it ends").stdout;
        assert_eq!(String::from_utf8_lossy(&read), folder.read("plain.obj"));
        if Path::new("/dev/full").exists() {
            let complaint = folder.complaint(&["shape", "sphere", "-o", "/dev/full"]);
            assert!(complaint.contains("/dev/full cannot be written"), "{complaint}");
        }
    }

    #[test]
    fn a_file_that_may_not_grow_is_an_error_and_leaves_nothing() {
        let folder = Folder::new();
        let done = shell(&folder, "ulimit -f 20", "shape sphere --vertices 5000 -o out.obj");
        assert_eq!(done.status.code(), Some(1), "{done:?}");
        assert!(String::from_utf8_lossy(&done.stderr).contains("out.obj cannot be written"), "{done:?}");
        assert!(folder.names().is_empty(), "{:?}", folder.names());
    }

    #[test]
    fn where_memory_is_short_there_is_no_signal_and_no_half_file() {
        let folder = Folder::new();
        folder.run(&["shape", "hare", "--vertices", "20000", "-o", "hare.obj"]).success();
        let mut codes = Vec::new();
        for megabytes in [40, 60, 80, 100, 120, 140, 160, 200, 300, 400] {
            let limit = format!("ulimit -v {} 2> /dev/null || ulimit -d {0}", megabytes * 1024);
            let args = "unwrap hare.obj -n 4 --method persistence -o out.obj --picture out.png --layout out.svg";
            let done = shell(&folder, &limit, args);
            let code = done.status.code();
            assert!(
                matches!(code, Some(0 | 1)),
                "{megabytes} MB: {:?} {}",
                done.status,
                String::from_utf8_lossy(&done.stderr)
            );
            assert!(!String::from_utf8_lossy(&done.stderr).contains("panicked"), "{megabytes} MB: {done:?}");
            assert_eq!(unfinished(&folder), Vec::<String>::new(), "{megabytes} MB");
            codes.extend(code);
        }
        if !codes.contains(&1) {
            println!("skipped: memory cannot be limited here");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_shape_that_memory_cannot_hold_is_refused_in_a_sentence() {
        let folder = Folder::new();
        let done = shell(&folder, "ulimit -v 300000", "shape sphere --vertices 3000000 -o out.obj");
        assert_eq!(done.status.code(), Some(1));
        let told = String::from_utf8_lossy(&done.stderr);
        assert!(
            told.starts_with("error: sphere has 3000000 vertices, which need more than 414 MB of memory"),
            "{told}"
        );
        assert_eq!(told.lines().count(), 1, "{told}");
    }

    /// A running command that has written some of its files and waits for somebody to read the next one, `pipe.vtp`.
    fn waiting(folder: &Folder, before: &str) -> Child {
        assert!(Command::new("mkfifo").arg(folder.path("pipe.vtp")).status().expect("there is a mkfifo").success());
        let args = "unwrap hare.obj -n 6 -o out.obj --checker --cones-out cones.txt --vtp pipe.vtp --report out.json --layout out.svg";
        let script = format!("{before}\nexec \"$0\" {args}");
        let mut shell = Command::new("sh");
        shell.args(["-c", &script, PROGRAM]).current_dir(folder.root()).stdout(Stdio::null());
        let running = shell.spawn().expect("there is a shell");
        // The surface, a material, its picture, and the cones.
        let began = Instant::now();
        while unfinished(folder).len() < 4 {
            assert!(began.elapsed() < Duration::from_secs(60), "{:?} wait for their names", unfinished(folder));
            sleep(Duration::from_millis(5));
        }
        running
    }

    fn send(signal: &str, to: &Child) {
        assert!(Command::new("kill").args([signal, &to.id().to_string()]).status().expect("there is a kill").success());
    }

    /// Whether who started the tests had closed terminals ignored, as `nohup` does: who is started by them does the same.
    fn is_under_nohup() -> bool {
        let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
        status
            .lines()
            .any(|line| line.starts_with("SigIgn:") && line.ends_with(['1', '3', '5', '7', '9', 'b', 'd', 'f']))
    }

    #[test]
    fn a_signal_leaves_everything_as_it_was() {
        let mut signals = vec![("-INT", 130), ("-TERM", 143)];
        if cfg!(target_os = "linux") && !is_under_nohup() {
            signals.push(("-HUP", 129));
        }
        for (signal, code) in signals {
            let folder = Folder::with_shapes();
            folder.write("out.obj", "before");
            let mut running = waiting(&folder, "");
            let names = folder.names();
            let began = Instant::now();
            send(signal, &running);
            assert_eq!(running.wait().expect("it ends").code(), Some(code), "{signal}");
            assert!(began.elapsed() < Duration::from_secs(4), "{signal}");
            assert_eq!(folder.read("out.obj"), "before");
            let left: Vec<String> = names.into_iter().filter(|name| !name.starts_with('.')).collect();
            assert_eq!(folder.names(), left, "{signal}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_nohup_starts_outlives_its_terminal() {
        let folder = Folder::with_shapes();
        let mut running = waiting(&folder, "trap '' HUP");
        send("-HUP", &running);
        assert!(!fs::read(folder.path("pipe.vtp")).expect("it is written to").is_empty());
        assert!(running.wait().expect("it ends").success());
        assert!(folder.read("out.obj").contains("vt ") && folder.path("out.json").exists());
    }

    #[test]
    fn a_signal_does_not_wait_for_a_large_file() {
        let folder = Folder::new();
        let mut command = Command::new(PROGRAM);
        command.args(["shape", "sphere", "--vertices", "2000000", "-o", "out.obj.gz"]).current_dir(folder.root());
        let mut running = command.spawn().expect("the command starts");
        while unfinished(&folder).is_empty() {
            sleep(Duration::from_millis(5));
        }
        send("-INT", &running);
        assert_eq!(running.wait().expect("it ends").code(), Some(130));
        assert_eq!(folder.names(), Vec::<String>::new());
    }

    #[test]
    fn where_one_file_cannot_be_written_none_is() {
        if !Path::new("/dev/full").exists() {
            println!("skipped: there is no /dev/full here");
            return;
        }
        let folder = Folder::with_shapes();
        symlink("/dev/full", folder.path("full.vtp")).expect("links can be made");
        folder.write("out.obj", "before");
        let names = folder.names();
        let args = [
            "unwrap",
            "hare.obj",
            "-n",
            "6",
            "-o",
            "out.obj",
            "--checker",
            "--report",
            "out.json",
            "--vtp",
            "full.vtp",
        ];
        let complaint = folder.complaint(&args);
        assert!(complaint.contains("full.vtp cannot be written"), "{complaint}");
        assert_eq!((folder.read("out.obj"), folder.names()), ("before".to_owned(), names));
    }

    #[test]
    fn without_further_threads_the_main_one_does_the_work() {
        let folder = Folder::with_shapes();
        folder.run(&["unwrap", "hare.obj", "-n", "6", "-o", "many.obj"]).success();
        // No system has room for such stacks.
        let done = shell(&folder, "export RUST_MIN_STACK=70368744177664", "unwrap hare.obj -n 6 -o one.obj");
        assert!(done.status.success(), "{done:?}");
        assert_eq!(folder.read("one.obj"), folder.read("many.obj"));
    }

    #[test]
    fn messages_are_coloured_on_terminals_only() {
        let folder = Folder::new();
        let complain =
            |before: &str| String::from_utf8_lossy(&shell(&folder, before, "extract missing.obj").stderr).into_owned();
        assert!(complain("").starts_with("error: "));
        assert!(complain("export CLICOLOR_FORCE=1").starts_with("\u{1b}[1m\u{1b}[31merror:\u{1b}[0m "));
        assert!(complain("export CLICOLOR_FORCE=1 NO_COLOR=1").contains("error:"));
    }
}

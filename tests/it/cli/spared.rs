//! Nothing that a command read is written over, and what is replaced is replaced with care.

use std::{
    fs,
    os::unix::fs::{MetadataExt as _, PermissionsExt as _, symlink},
    path::Path,
    process::{Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use crate::support::{command, run_line, said, sample, scratch};

/// A folder with a bag, a run, limits, a plant, a plan and a task of an own arm.
fn workshop() -> tempfile::TempDir {
    let folder = scratch();
    let path = folder.path();
    fs::create_dir(path.join("bag")).unwrap();
    fs::copy(sample("task-1-run.mcap"), path.join("bag/bag_0.mcap")).unwrap();
    fs::copy(sample("task-1-run.mcap"), path.join("run.mcap")).unwrap();
    let metadata =
        "rosbag2_bagfile_information:\n  storage_identifier: mcap\n  relative_file_paths: [bag_0.mcap]\n";
    fs::write(path.join("bag/metadata.yaml"), metadata).unwrap();
    fs::copy(sample("plc-trace.csv"), path.join("trace.csv")).unwrap();
    fs::write(path.join("map.toml"), "rate_hz = 100\n").unwrap();
    for line in ["fit run.mcap -o limits.toml", "plan task-1.toml --times 0,20,40,60,82,102 -o plan.mcap"] {
        let (code, _, error) = said(&run_line(path, line));
        assert_eq!(code, 0, "{line}: {error}");
    }
    own_arm(path);
    let plant = fs::read_dir(sample("plant")).unwrap().next().unwrap().unwrap().path();
    fs::copy(plant, path.join("plant.toml")).unwrap();
    folder
}

/// `own.toml`: the task on an arm with files of its own.
fn own_arm(path: &Path) {
    for file in ["arm.urdf", "hydraulics.toml"] {
        fs::copy(sample("arm").join(file), path.join(file)).unwrap();
    }
    let task = fs::read_to_string(path.join("task-1.toml")).unwrap();
    let arm = "arm = \"arm.urdf\"\nhydraulics = \"hydraulics.toml\"";
    fs::write(path.join("own.toml"), task.replace("arm = \"sample\"", arm)).unwrap();
}

#[test]
fn no_file_that_was_read_is_written_over_whatever_its_name() {
    let folder = workshop();
    let path = folder.path();
    symlink("bag/bag_0.mcap", path.join("link.json")).unwrap();
    fs::hard_link(path.join("bag/bag_0.mcap"), path.join("twin.json")).unwrap();
    for (line, output) in [
        ("report bag --json", "bag/bag_0.mcap"),
        ("report bag --json", "bag/metadata.yaml"),
        ("report bag --json", "link.json"),
        ("report bag --json", "twin.json"),
        ("report bag --json", "bag/../bag/bag_0.mcap"),
        ("report run.mcap --html --limits limits.toml", "limits.toml"),
        ("report bag --figures drawn", "bag/metadata.yaml"),
        ("export bag --csv", "bag/bag_0.mcap"),
        ("fit bag", "bag/bag_0.mcap"),
        ("replan run.mcap --limits limits.toml --keep-plan", "limits.toml"),
        ("replan bag --keep-plan", "bag/bag_0.mcap"),
        ("compare bag run.mcap --json", "bag/bag_0.mcap"),
        ("join bag --plan plan.mcap", "plan.mcap"),
        ("import trace.csv --map map.toml", "map.toml"),
        ("simulate plan.mcap", "plan.mcap"),
        ("plan task-1.toml --times 0,20,40,60,82,102", "task-1.toml"),
        ("plan own.toml --times 0,20,40,60,82,102", "arm.urdf"),
        ("plan own.toml --times 0,20,40,60,82,102", "hydraulics.toml"),
        ("excite --task own.toml", "arm.urdf"),
        ("simulate plan.mcap --plant plant.toml", "plant.toml"),
        ("recover run.mcap", "run.mcap"),
    ] {
        let before = fs::read(path.join(output)).unwrap();
        let count = fs::read_dir(path).unwrap().count();
        for force in ["", " --force"] {
            let (code, text, error) = said(&run_line(path, &format!("{line} -o {output}{force}")));
            assert_eq!(text, "", "{line} -o {output}{force}");
            // Of a log the name alone may be enough to refuse it, before anything is read.
            let why = match code {
                2 => "what is written to",
                _ if force.is_empty() && error.contains("--force") => "give the output another name",
                _ => "is an input of this command",
            };
            assert!((1..=2).contains(&code) && error.contains(why), "{line} -o {output}{force}: {error}");
            assert!(fs::read(path.join(output)).unwrap() == before, "{line} -o {output}");
            assert_eq!(
                fs::read_dir(path).unwrap().count(),
                count,
                "{line} -o {output}: something was written"
            );
        }
    }
}

#[test]
fn recordings_and_commands_are_replaced_only_by_force() {
    let folder = workshop();
    let path = folder.path();
    let made = said(&run_line(path, "replan run.mcap --limits limits.toml --keep-plan -o next.mcap"));
    assert!(matches!(made.0, 0 | 3), "{made:?}");
    fs::copy(sample("panel-install.mcap"), path.join("recorded.mcap")).unwrap();
    fs::write(path.join("old.db3"), b"SQLite format 3\0and so on").unwrap();
    fs::write(path.join("metadata.yaml"), "rosbag2_bagfile_information:\n  version: 5\n").unwrap();
    fs::write(path.join("other.urdf"), "<?xml version=\"1.0\"?>\n<robot name=\"other\"/>\n").unwrap();
    fs::write(path.join("site.html"), "\u{feff}<!-- ours -->\n<html>the company's</html>").unwrap();
    fs::write(path.join("plain.html"), "the company's").unwrap();
    assert_eq!(said(&run_line(path, "export run.mcap -o own.parquet")).0, 0);
    let mut other = fs::read(path.join("own.parquet")).unwrap();
    let footer = other.len() - other.len().min(2000);
    for at in footer..other.len() - 10 {
        if &other[at..at + 10] == b"hydrotrace" {
            other[at..at + 10].copy_from_slice(b"other prog");
        }
    }
    fs::write(path.join("other.parquet"), other).unwrap();
    for output in [
        "recorded.mcap", "next.mcap", "old.db3", "trace.csv", "metadata.yaml", "other.urdf", "site.html",
        "plain.html", "other.parquet",
    ] {
        let before = fs::read(path.join(output)).unwrap();
        let (code, text, error) = said(&run_line(path, &format!("report run.mcap --json -o {output}")));
        assert_eq!((code, text.as_str()), (1, ""), "{output}: {error}");
        assert!(error.contains(output) && error.contains("--force"), "{error}");
        assert!(fs::read(path.join(output)).unwrap() == before, "{output}");
        let (code, _, error) = said(&run_line(path, &format!("report run.mcap --json -o {output} --force")));
        assert_eq!(code, 0, "{output}: {error}");
        assert!(fs::read(path.join(output)).unwrap().starts_with(b"{"), "{output}");
    }
    // What can be made again is.
    for day in 1..7 {
        fs::create_dir_all(path.join(format!("logs/2026-03-0{day}"))).unwrap();
        fs::copy(sample("plc-trace.csv"), path.join(format!("logs/2026-03-0{day}/run.csv"))).unwrap();
    }
    let (code, _, error) =
        said(&run_line(path, "fleet scan logs/**/*.csv --into fleet --machine-from path:2"));
    assert!(matches!(code, 0 | 3), "{error}");
    for line in [
        "plan task-1.toml --times 0,20,40,60,82,102 -o plan.mcap",
        "simulate plan.mcap -o simulated.mcap",
        "export run.mcap -o table.csv",
        "export run.mcap -o own.parquet",
        "report run.mcap -o starts.csv",
        "report run.mcap -o report.md",
        "compare run.mcap run.mcap -o compare.md",
        "fleet worst fleet -o worst.csv",
        "fleet worst fleet -o worst.md",
        "fleet worst fleet -o worst.html",
        "fleet drift fleet -o drift.csv",
        "fit run.mcap -o limits.toml",
    ] {
        for time in ["first", "second"] {
            let (code, _, error) = said(&run_line(path, line));
            assert!(
                code == 0
                    || code == 3 && line.contains("run.mcap run.mcap")
                    || code == 3 && line.starts_with("fleet"),
                "{line}, {time}: {error}"
            );
        }
    }
}

#[test]
fn what_is_replaced_keeps_its_mode_and_its_name_may_be_as_long_as_names_are() {
    let folder = workshop();
    let path = folder.path();
    let name = format!("{}.json", "n".repeat(250));
    for mode in [0o600, 0o640, 0o755] {
        fs::write(path.join(&name), "{\n  \"format\": \"hydrotrace.report.v2\"\n}").unwrap();
        fs::set_permissions(path.join(&name), fs::Permissions::from_mode(mode)).unwrap();
        let inode = path.join(&name).metadata().unwrap().ino();
        let (code, _, error) = said(&run_line(path, &format!("report run.mcap -o {name}")));
        assert_eq!(code, 0, "{error}");
        let found = path.join(&name).metadata().unwrap();
        assert_eq!(found.permissions().mode() & 0o7777, mode);
        assert!(found.ino() != inode && found.len() > 1000);
    }
}

/// Names of files that are no one's result.
fn left(path: &Path) -> Vec<String> {
    let names = fs::read_dir(path).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.contains("partial")).collect()
}

#[test]
fn an_interrupt_leaves_nothing_and_what_a_kill_left_is_gone_after_the_next_run() {
    let folder = workshop();
    let path = folder.path();
    let mut caught = [0, 0];
    for attempt in 0..60 {
        let signal = ["INT", "KILL"][attempt % 2];
        let mut run = command(path);
        let mut run = run.args(["export", "run.mcap", "--csv", "-o", "table.csv"]);
        run = run.stdout(Stdio::null()).stderr(Stdio::null());
        let mut run = run.spawn().unwrap();
        let (patience, id) = (Instant::now(), run.id().to_string());
        let own = || left(path).into_iter().filter(|name| name.contains(&format!("-{id}-"))).count();
        // Once its file is there it is being written.
        while own() == 0 && run.try_wait().unwrap().is_none() {
            assert!(patience.elapsed() < Duration::from_secs(60));
            thread::sleep(Duration::from_micros(200));
        }
        let _ =
            Command::new("kill").args([&format!("-{signal}"), id.as_str()]).stderr(Stdio::null()).status();
        let ended = run.wait().unwrap();
        caught[attempt % 2] += u32::from(!ended.success());
        if signal == "INT" {
            assert_eq!(own(), 0, "attempt {attempt}");
        }
    }
    assert!(caught.iter().all(|caught| *caught > 0), "no run was caught writing: {caught:?}");
    assert_eq!(said(&run_line(path, "export run.mcap --csv -o table.csv")).0, 0);
    assert_eq!(left(path), Vec::<String>::new());
}

#[test]
fn a_writer_by_name_replaces_the_file_when_it_is_done_and_not_when_it_fails() {
    use hydrotrace::atomic_file::{AtomicError, write_by_name};
    let folder = tempfile::tempdir().unwrap();
    let target = folder.path().join("run.rrd");
    fs::write(&target, "old").unwrap();
    let write = |good: bool| {
        write_by_name(&target, |path| {
            fs::write(path, "new").unwrap();
            assert_eq!(fs::read_to_string(&target).unwrap(), "old");
            if good { Ok(()) } else { Err(AtomicError::NotAFile { path: "given up".into() }) }
        })
    };
    assert!(write(false).is_err());
    assert_eq!(fs::read_to_string(&target).unwrap(), "old");
    assert!(write(true).is_ok());
    assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_file_of_another_program_is_kept_whatever_its_name_and_an_own_one_is_replaced() {
    let folder = scratch();
    let path = folder.path();
    fs::copy(sample("task-1-run.mcap"), path.join("run.mcap")).unwrap();
    fs::copy(sample("precompensated-run.mcap"), path.join("other.mcap")).unwrap();
    fs::create_dir(path.join("drawn")).unwrap();
    let foreign = [
        ("report run.mcap -o notes.txt", "notes.txt", "Oil changed on Monday.\n"),
        ("report run.mcap -o README.md", "README.md", "# Machine 3\n\nOil changed on Monday.\n"),
        ("report run.mcap -o analysis.py", "analysis.py", "print(1)\n"),
        ("export run.mcap --csv -o log", "log", "first line\nsecond\n"),
        ("fit run.mcap -o limits.txt", "limits.txt", "12 bar\n"),
        ("export run.mcap -o cut.mcap", "cut.mcap", "\u{89}MCAP"),
        (
            "report run.mcap --figures drawn",
            "drawn/lag.svg",
            "<svg xmlns=\"http://www.w3.org/2000/svg\"><title/></svg>\n",
        ),
    ];
    for (line, file, text) in foreign {
        fs::write(path.join(file), text).unwrap();
        let (code, _, error) = said(&run_line(path, line));
        assert!(
            code == 1 && error.contains("a file that this program did not write"),
            "{line}: {code} {error}"
        );
        assert_eq!(fs::read_to_string(path.join(file)).unwrap(), text, "{line}");
        fs::remove_file(path.join(file)).unwrap();
    }
    for line in [
        "report run.mcap -o own.txt", "compare run.mcap other.mcap -o own.md",
        "report run.mcap --figures drawn",
    ] {
        for _ in 0..2 {
            let (code, _, error) = said(&run_line(path, line));
            assert_eq!(code, 0, "{line}: {error}");
        }
    }
}

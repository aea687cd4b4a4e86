//! Folders and arguments that make no sense.

use super::*;

#[test]
fn bad_arguments_are_named_and_change_nothing() {
    let folder = folder();
    let at = folder.path();
    write(at.join("file"), "");
    write(at.join("bare/notes.txt"), "no mesh");
    std::fs::create_dir(at.join("empty")).unwrap();
    let before = names(at);
    for (arguments, message) in [
        (vec!["batch", "missing", "-o", "out"], "cannot read the input folder missing"),
        (vec!["batch", "in/a.obj", "-o", "out"], "in/a.obj is a file; name its folder, or use packer pack"),
        (vec!["batch", "empty", "-o", "out"], "no meshes below empty; files that end in .obj, .stl"),
        (vec!["batch", "bare", "-o", "out"], "no meshes below bare"),
        (vec!["batch", "in", "-o", "file"], "the output file is a file; name a folder"),
        (vec!["batch", "in", "-o", "file/out"], "cannot make the output folder file/out"),
        (vec!["batch", "in"], "--output"),
        (vec!["batch", "in", "-o", "out", "--shard", "0/0"], "at least one shard"),
        (vec!["batch", "in", "-o", "out", "--shard", "0/2"], "counted from 1"),
        (vec!["batch", "in", "-o", "out", "--shard", "3/2"], "the last one is 2/2"),
        (vec!["batch", "in", "-o", "out", "--shard", "two"], "two whole numbers"),
        (vec!["batch", "in", "-o", "out", "--threads", "0"], "zero threads"),
        (vec!["batch", "in", "-o", "out", "--spheres", "0"], "zero spheres"),
        (vec!["batch", "in", "-o", "out", "--coverage", "2"], "coverage 2"),
        (vec!["batch", "in", "-o", "out", "--min-radius", "-1"], "minimum radius -1"),
        (vec!["batch", "in", "-o", "out", "--preset", "huge"], "fast, balanced, fine"),
    ] {
        let output = run(at, &arguments);
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains(message), "{arguments:?}: {stderr}");
        assert!(!stderr.contains("panicked") && output.stdout.is_empty(), "{arguments:?}: {stderr}");
    }
    assert_eq!(names(at), before);
    assert!(!at.join("out").exists());
}

#[test]
fn where_all_meshes_fail_no_folders_are_left_behind() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write(at.join("in/deep/bad.obj"), "v 0 0 0\n");
    assert_eq!(counts(&batch(at, &[])), [0, 0, 1]);
    assert_eq!(std::fs::read_dir(at.join("out")).unwrap().count(), 0);
}

//! Parts of a batch on several machines.

use super::*;

#[test]
fn shards_together_are_one_run() {
    let folder = folder();
    let at = folder.path();
    batch(at, &[]);
    let whole = contents(&at.join("out"));
    for count in [1, 2, 3, 20] {
        let out = format!("out of {count}");
        let mut seen = Vec::new();
        // In any order, and one after the other, so that each finds the outputs of those before it.
        for index in (1..=count).rev() {
            let shard = format!("{index}/{count}");
            let output = run(at, &["batch", "in", "-o", &out, "-n", "40", "--json", "--shard", &shard]);
            assert!(output.status.success(), "{output:?}");
            let report: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(
                (report["shard"].as_str(), report["meshes_in_all_shards"].as_u64()),
                (Some(&*shard), Some(8))
            );
            let meshes = report["meshes"].as_array().unwrap();
            assert_eq!(counts(&report), [meshes.len() as u64, 0, 0]);
            seen.extend(meshes.iter().map(|mesh| mesh["input"].as_str().unwrap().to_owned()));
        }
        seen.sort();
        assert_eq!(seen, OUTPUTS.map(|name| name.strip_suffix(".ist").unwrap()), "{count}");
        assert!(contents(&at.join(&out)) == whole, "{count}");
    }
}

#[test]
fn a_mesh_keeps_its_shard_when_others_come_and_go() {
    let folder = folder();
    let at = folder.path();
    let listed = || -> Vec<String> {
        let report = batch(at, &["--shard", "2/3"]);
        report["meshes"].as_array().unwrap().iter().map(|m| m["input"].as_str().unwrap().to_owned()).collect()
    };
    let before = listed();
    assert!(!before.is_empty());
    write(at.join("in/0 first.obj"), obj(&cuboid(1.0, 1.0, 9.0)));
    let after: Vec<String> = listed().into_iter().filter(|name| name != "0 first.obj").collect();
    assert_eq!(before, after);
}

#[test]
fn a_failed_mesh_is_told_by_its_own_shard_only() {
    let folder = folder();
    let at = folder.path();
    write(at.join("in/bad.obj"), "v 0 0 0\n");
    let failed: u64 = (1..=3).map(|index| counts(&batch(at, &["--shard", &format!("{index}/3")]))[2]).sum();
    assert_eq!(failed, 1);
}

#[test]
fn a_shard_without_meshes_is_no_error() {
    let folder = TempDir::new().unwrap();
    let at = folder.path();
    write(at.join("in/only.obj"), obj(&cuboid(1.0, 1.0, 1.0)));
    let sizes: Vec<usize> = (1..=5)
        .map(|index| {
            let output = run(at, &["batch", "in", "-o", "out", "-n", "9", "--shard", &format!("{index}/5")]);
            assert!(output.status.success(), "{output:?}");
            usize::from(String::from_utf8(output.stdout).unwrap().contains("1 packed"))
        })
        .collect();
    assert_eq!(sizes.iter().sum::<usize>(), 1);
}

#[test]
fn unfinished_files_of_ones_own_shard_are_removed_and_no_others() {
    let folder = folder();
    let at = folder.path();
    // The hash in the name is 2 for the first of two shards, 3 for the second.
    let own = ["out/.packer-00000002-aBc123", "out/rings/.packer-0000000e-x"];
    let others = [
        "out/.packer-00000003-aBc123",
        "out/.packer-notes",
        "out/.packer-0000002-short",
        "out/packer-00000002-visible",
        "out/.packer-00000002",
    ];
    own.iter().chain(&others).for_each(|name| write(at.join(name), "half a packing"));
    batch(at, &["--shard", "1/2"]);
    assert!(own.iter().all(|name| !at.join(name).exists()));
    assert!(others.iter().all(|name| at.join(name).exists()));
    batch(at, &[]);
    assert!(!at.join(others[0]).exists(), "one run of all shards owns all");
}

//! Surroundings of a field solver that do not fit: another OpenFOAM, another MPI, programs that are missing.

use amberfield_tests::FoamBox;

#[test]
fn foreign_openfoam_mpi_and_libraries_are_named() {
    let scene = FoamBox::grounded();
    let bench = &scene.bench;
    let program = |name: &str, text: &str| {
        bench.write(name, format!("#!/bin/sh\n{text}\n"));
        let permissions = std::os::unix::fs::PermissionsExt::from_mode(0o755);
        std::fs::set_permissions(bench.path(name), permissions).unwrap();
    };
    std::fs::create_dir(bench.path("bin")).unwrap();
    program("bin/mpirun", "echo HYDRA build details:; exit 1");
    let path = format!("{}:{}", bench.path("bin").display(), std::env::var("PATH").unwrap());
    let foreign = |command: &mut std::process::Command| {
        let output = command.env("PATH", &path).env("FOAM_LIBBIN", "/opt/other/lib").output().unwrap();
        let said = [output.stdout, output.stderr].concat();
        String::from_utf8_lossy(&said).into_owned()
    };
    let said = foreign(&mut bench.command(&["doctor"]));
    let is_named = |said: &str| said.contains("HYDRA") && said.contains("libraries in /opt/other/lib");
    assert!(is_named(&said), "{said}");
    let options = ["field", "scene.toml", "--out", "out.csv", "--set", "solver.ranks=2"];
    let said = foreign(&mut bench.command(&options));
    assert!(said.contains("the field solver is gone") && is_named(&said), "{said}");

    let said = String::from_utf8_lossy(
        &bench.command(&options).env("PATH", bench.path("bin")).output().unwrap().stderr,
    )
    .into_owned();
    assert!(said.contains("decomposePar is not on the PATH") && !said.contains("xtask"), "{said}");
}

//! The C header is what the library's source says, and a compiler finds all that it names.

use amberfield_capi::{
    AmberfieldContact, AmberfieldFar, AmberfieldFlow, AmberfieldHostSettings, AmberfieldLetter,
    AmberfieldMesh, AmberfieldRanks, AmberfieldRequest,
};
use amberfield_wire::payloads::{
    BoundaryFace, FarQuestion, FlowAnswer, FlowQuestion, MeshOutline, SourceCloud,
};
use std::mem::size_of;
use std::path::{Path, PathBuf};

/// The variable that makes this test write the header instead: `cargo xtask header` sets it.
const WRITE: &str = "AMBERFIELD_WRITE_HEADER";
/// Sources of the header, the shared structures of other crates among them.
const SOURCES: [&str; 17] = [
    "src/status.rs",
    "src/field_question.rs",
    "src/field_side.rs",
    "src/field_flow.rs",
    "src/field_letters.rs",
    "src/field_potentials.rs",
    "src/host_settings.rs",
    "src/host_ranks.rs",
    "src/host.rs",
    "src/host_side.rs",
    "src/host_parameters.rs",
    "src/charge_laws.rs",
    "../core/src/far_question.rs",
    "../wire/src/payloads/boundary_face.rs",
    "../wire/src/payloads/flow_answer.rs",
    "../wire/src/payloads/flow_question.rs",
    "../wire/src/payloads/mesh_outline.rs",
];
/// Size of every structure here, by its name there [bytes].
const SIZES: [(&str, usize); 14] = [
    ("AmberfieldBoundaryFace", size_of::<BoundaryFace>()),
    ("AmberfieldContact", size_of::<AmberfieldContact>()),
    ("AmberfieldFar", size_of::<AmberfieldFar>()),
    ("AmberfieldFarQuestion", size_of::<FarQuestion>()),
    ("AmberfieldFlow", size_of::<AmberfieldFlow>()),
    ("AmberfieldFlowAnswer", size_of::<FlowAnswer>()),
    ("AmberfieldFlowQuestion", size_of::<FlowQuestion>()),
    ("AmberfieldHostSettings", size_of::<AmberfieldHostSettings>()),
    ("AmberfieldLetter", size_of::<AmberfieldLetter>()),
    ("AmberfieldMesh", size_of::<AmberfieldMesh>()),
    ("AmberfieldMeshOutline", size_of::<MeshOutline>()),
    ("AmberfieldRanks", size_of::<AmberfieldRanks>()),
    ("AmberfieldRequest", size_of::<AmberfieldRequest>()),
    ("AmberfieldSourceCloud", size_of::<SourceCloud>()),
];
/// Beginning of the names of all types.
const PREFIX: &str = "Amberfield";

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn header() -> String {
    std::fs::read_to_string(root().join("include/amberfield.h")).unwrap_or_default()
}

#[test]
fn committed_header_is_that_of_the_source() {
    let root = root();
    let config = cbindgen::Config::from_file(root.join("cbindgen.toml")).expect("a good configuration");
    let mut builder = cbindgen::Builder::new().with_config(config);
    for source in SOURCES {
        builder = builder.with_src(root.join(source));
    }
    let bindings = builder.generate().expect("a good source");
    let mut text = Vec::new();
    bindings.write(&mut text);
    let text = String::from_utf8(text).expect("UTF-8");
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(root.join("include/amberfield.h"), &text).expect("the header can be written");
    }
    assert!(header() == text, "include/amberfield.h is stale: run `cargo xtask header`");
}

/// Names of types in a text: words that begin with the prefix, up to an underscore.
fn names(text: &str) -> Vec<&str> {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric());
    let mut names: Vec<&str> =
        words.filter(|word| word.starts_with(PREFIX) && word.len() > PREFIX.len()).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// Types that the header declares, by the word before their names: complete ones with their bodies, others,
/// those of functions among them, without.
fn declared<'a>(header: &'a str, kind: &str) -> Vec<(&'a str, Option<&'a str>)> {
    let start = format!("typedef {kind} ");
    let mut found = Vec::new();
    for (place, _) in header.match_indices(&start) {
        let rest = &header[place + start.len()..];
        let name = names(rest.lines().next().expect("a line")).first().copied().expect("a name");
        let body = rest.trim_start_matches("(*")[name.len()..]
            .trim_start()
            .strip_prefix('{')
            .map(|rest| &rest[..end_of(rest, "\n}")]);
        found.push((name, body));
    }
    found
}

fn end_of(text: &str, what: &str) -> usize {
    text.find(what).expect("an end")
}

/// Last words of the lines of a body that are no comments: fields, or values of an enum.
fn members(body: &str) -> Vec<&str> {
    let lines = body.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
    lines
        .map(|line| {
            let line = line.trim_end_matches([',', ';']);
            let line = line.split(" = ").next().unwrap_or(line);
            let line = line.split('[').next().unwrap_or(line);
            line.rsplit([' ', '*']).next().unwrap_or(line)
        })
        .collect()
}

/// A program that uses every value of every enum, every field of every structure and every function of the
/// header.
fn program(header: &str) -> String {
    let mut text = String::from("#include \"amberfield.h\"\n\n");
    for (name, body) in declared(header, "enum") {
        text += &format!("int value_of_{name}({name} value);\nint value_of_{name}({name} value)\n{{\n");
        text += "    switch (value) {\n";
        for (place, value) in members(body.expect("an enum has values")).iter().enumerate() {
            text += &format!("    case {value}: return {place};\n");
        }
        text += "    }\n    return -1;\n}\n\n";
    }
    for (name, body) in declared(header, "struct") {
        text +=
            &format!("size_t bytes_of_{name}({name} *value);\nsize_t bytes_of_{name}({name} *value)\n{{\n");
        let fields = body.map(members).unwrap_or_default();
        let sizes: Vec<String> = fields.iter().map(|field| format!("sizeof value->{field}")).collect();
        let sum = if sizes.is_empty() { "sizeof value".to_owned() } else { sizes.join(" + ") };
        text += &format!("    return value ? {sum} : 0;\n}}\n\n");
    }
    for (name, bytes) in SIZES {
        text += &format!("typedef char size_of_{name}[sizeof({name}) == {bytes} ? 1 : -1];\n");
    }
    text += "\ntypedef void (*any_function)(void);\nany_function functions[] = {\n";
    for function in functions(header) {
        text += &format!("    (any_function){function},\n");
    }
    text + "};\n"
}

/// Functions that the header declares.
fn functions(header: &str) -> Vec<&str> {
    let code = header.lines().filter(|line| !line.trim_start().starts_with("//"));
    code.filter_map(|line| line.split('(').next())
        .filter_map(|start| start.rsplit([' ', '*']).next())
        .filter(|name| name.starts_with("amberfield_"))
        .collect()
}

#[test]
fn every_type_that_the_header_names_is_declared() {
    let header = header();
    let kinds = ["enum", "struct", "int32_t"];
    let known: Vec<&str> =
        kinds.iter().flat_map(|kind| declared(&header, kind)).map(|(name, _)| name).collect();
    for name in names(&header) {
        assert!(known.contains(&name), "{name} is named and not declared");
    }
    assert!(known.contains(&"AmberfieldBoundary") && known.contains(&"AmberfieldFarQuestion"), "{known:?}");
}

#[test]
fn c_and_cpp_compilers_find_every_value_every_field_and_every_function() {
    let header = header();
    let text = program(&header);
    for expected in [
        "case AmberfieldBoundary_Open:",
        "sizeof value->permittivity_f_m",
        "(any_function)amberfield_host_field",
    ] {
        assert!(text.contains(expected), "{expected} is not in\n{text}");
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let flags = ["-Wall", "-Wextra", "-Wswitch-enum", "-Werror", "-pedantic", "-fsyntax-only", "-I"];
    for (compiler, language, standard) in [("cc", "c", "-std=c99"), ("c++", "c++", "-std=c++14")] {
        let file = folder.join(format!("uses_header.{}", if language == "c" { "c" } else { "cc" }));
        std::fs::write(&file, &text).expect("a file can be written");
        let mut command = std::process::Command::new(compiler);
        command.arg(standard).args(flags).arg(root().join("include")).arg(&file);
        let output = command.output().unwrap_or_else(|error| panic!("{compiler}: {error}"));
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{compiler} refuses\n{text}\n{said}");
    }
}

//! Dialects of tables: separators, decimal signs, comments and compression do not matter.

use crate::common::{Folder, GRAINS};
use flate2::{Compression, write::GzEncoder};
use std::io::Write as _;

/// Good table of [`Folder`] with numbers that have decimals.
const PLAIN: &str = "id,x_m,y_m,z_m,diameter_mm,charge_pC,material,group\n\
    1,0.001,0.0015,0.001,0.25,-1.5,glass,fine\n\
    2,0.002,0.001,0.001,0.5,2,glass,all\n\
    7,3.5e-3,0.001,0.001,0.2,0,steel,coarse\n";

/// Bytes compressed with gzip.
pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn separators_decimal_signs_comments_and_compression_do_not_matter() {
    let folder = Folder::good();
    folder.write("grains.csv", PLAIN);
    let plain = folder.read(&[]).unwrap().particles;
    let semicolons = PLAIN.replace(',', ";");
    let commas = semicolons.replace('.', ",");
    let quoted = PLAIN.replace("glass", "\"glass\"").replace("id", "\"id\"");
    let variants: [(&str, Vec<u8>); 14] = [
        ("semicolons", semicolons.clone().into()),
        ("decimal commas", commas.clone().into()),
        ("Excel's first line", format!("sep=;\r\n{}", commas.replace('\n', "\r\n")).into()),
        ("tabs", PLAIN.replace(',', "\t").into()),
        ("tabs and decimal commas", commas.replace(';', "\t").into()),
        ("blanks", PLAIN.replace(',', "  ").replace('\n', "\n   ").into()),
        ("blanks and decimal commas", commas.replace(';', " \t ").into()),
        ("comments", format!("# made by hand; 1,5\n\n{}# end\n", PLAIN.replace("\n2,", "\n#x\n2,")).into()),
        (
            "comments among blanks",
            format!("# a;b\n{}", PLAIN.replace(',', " ").replace("\n2", "\n# x\n\n2")).into(),
        ),
        ("mark and line ends", format!("\u{feff}{}", commas.replace('\n', "\r\n")).into()),
        ("quotes", quoted.clone().into()),
        ("quotes among blanks", quoted.replace(',', " ").into()),
        ("gzip", gzip(PLAIN.as_bytes())),
        ("two parts of gzip", [gzip(&PLAIN.as_bytes()[..99]), gzip(&PLAIN.as_bytes()[99..])].concat()),
    ];
    for (name, bytes) in variants {
        folder.write("grains.csv", bytes);
        let read = folder.read(&[]).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(read.particles, plain, "{name}");
    }
    folder.write("charges.csv", gzip(b"# three\ncharge_pC;n\n1,5\n"));
    assert!(
        folder
            .refusal(&["particles={ generate = { material = 'glass', count = 1, radius_m = 1e-4, \
                              charge_C = { from_file = 'charges.csv' } } }"])
            .contains("unknown column \"n\"")
    );
    folder.write("charges.csv", gzip(b"# three\ncharge_pC \n1.5\n"));
    let generate = "particles={ generate = { material = 'glass', count = 1, radius_m = 1e-4, \
                    charge_C = { from_file = 'charges.csv' } } }";
    assert_eq!(folder.read(&[generate]).unwrap().particles.charge, [1.5e-12]);
}

#[test]
fn masses_become_densities() {
    let folder = Folder::good();
    let table = |head: &str, cells: &str| {
        format!(
            "id,x_m,y_m,z_m,radius_m,charge_C,material,{head}\n1,0.001,0.001,0.001,1e-4,0,glass,{cells}\n"
        )
    };
    folder.write("grains.csv", table("mass_ug", "10"));
    let density = folder.read(&[]).unwrap().particles.density[0];
    assert!((density / (1e-8 / (4.0 / 3.0 * std::f64::consts::PI * 1e-12)) - 1.0).abs() < 1e-14, "{density}");
    folder.write("grains.csv", table("mass_ug,density_kg_m3", "10,2500"));
    assert!(folder.refusal(&[]).contains("beside the density; remove one"));
    folder.write("grains.csv", table("mass_kg", "10"));
    assert!(folder.refusal(&[]).contains("mass_kg = \"10\": a density of"));
}

#[test]
fn tables_that_cannot_be_understood_are_refused() {
    let folder = Folder::good();
    let semicolons = GRAINS.replace(',', ";");
    for (bytes, said) in [
        (semicolons.replace("0.003", "0,003").into_bytes(), "grains.csv:4: x_m = \"0,003\": some decimals"),
        (
            semicolons.replace("0.003", "1.000,5").into_bytes(),
            "grains.csv:4: x_m = \"1.000,5\": not a number",
        ),
        (GRAINS.replace(',', " ").into_bytes(), "grains.csv:3: 7 values in a row of 8 columns"),
        (format!("# a\n# b\n{}", GRAINS.replace("0.003", "x")).into_bytes(), "grains.csv:6: x_m = \"x\""),
        (
            format!("# a\n# b\n\n{}", semicolons.replace("id", "ID")).into_bytes(),
            "grains.csv:4: unknown column",
        ),
        (gzip(GRAINS.as_bytes())[..50].to_vec(), "cannot be read to its end"),
        (
            gzip(GRAINS.replace("fine", "\u{fffd}").replace('\u{fffd}', "fin").as_bytes())[..60].to_vec(),
            "whole",
        ),
        (gzip(b""), "there is nothing in it"),
        (b"(\xb5/\xfd rest".to_vec(), "compressed with zstd"),
        (b"PK\x03\x04 rest".to_vec(), "save the table as CSV"),
        (b"\xff\xfei\0d\0".to_vec(), "UTF-16; save it as UTF-8"),
        (b"\x1f\x8b rest".to_vec(), "cannot be read to its end"),
    ] {
        folder.write("grains.csv", &bytes);
        let refusal = folder.refusal(&[]);
        assert!(refusal.contains(said), "{said}: {refusal}");
    }
    folder.write("grains.csv", GRAINS);
    assert!(folder.refusal(&["particles.units=si"]).contains("units is for dumps"));
    assert!(folder.refusal(&["particles.step=1"]).contains("step is for files with several frames"));
    assert!(folder.refusal(&["particles.materials_by_type=['glass']"]).contains("names materials itself"));
    assert!(folder.refusal(&["particles.materials_by_type=['glas']"]).contains("nearest is \"glass\""));
    assert!(folder.refusal(&["particles.units=lj"]).contains("\"si\""));
}

//! Corpora of the fuzzer, and changes of them, sent through all readers.

use amberfield_tests::any_bytes::TARGETS;
use std::path::Path;

/// Number of changed copies of each file of a corpus.
const CHANGES: u64 = 300;

#[test]
fn whatever_is_read_is_answered() {
    let corpora = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus");
    for (name, target) in TARGETS {
        let files: Vec<_> =
            std::fs::read_dir(corpora.join(name)).unwrap().map(|file| file.unwrap().path()).collect();
        assert!(!files.is_empty(), "{name}");
        for file in files {
            let good = std::fs::read(&file).unwrap();
            target(&good);
            for seed in 0..CHANGES {
                target(&changed(&good, seed));
            }
        }
    }
}

/// Copy with some bytes replaced, removed or inserted.
fn changed(good: &[u8], seed: u64) -> Vec<u8> {
    // Steele and Vigna's splitmix64.
    let mut state = seed;
    let mut random = move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let word = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        word ^ (word >> 31)
    };
    let mut bytes = good.to_vec();
    for _ in 0..=random() % 4 {
        let at = random() as usize % bytes.len().max(1);
        let byte = if random() % 2 == 0 {
            random() as u8
        } else {
            b"0123456789.e-\"\n[]=,\xff"[random() as usize % 20]
        };
        match random() % 3 {
            0 if at < bytes.len() => bytes[at] = byte,
            1 if at < bytes.len() => drop(bytes.remove(at)),
            _ => bytes.insert(at.min(bytes.len()), byte),
        }
    }
    bytes
}

//! The machine on which was measured, as a row of `data/DATE-machine.csv`.

use crate::peers::Peers;
use serde::{Deserialize, Serialize};

/// The machine and the programs of a run.
#[derive(Debug, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor; empty where the system does not tell.
    pub cpu: String,
    /// Cores.
    pub cores: usize,
    /// Widest vector instructions: avx512f, avx2 or sse2.
    pub vectors: String,
    /// Names and versions of the other programs; empty where none was measured.
    pub peers: String,
}

impl Machine {
    /// Reads what the system tells of this machine.
    #[must_use]
    pub fn read(peers: Option<&Peers>) -> Self {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let value = |key: &str| {
            let line = info.lines().find(|line| line.starts_with(key));
            line.and_then(|line| Some(line.split_once(':')?.1.trim().to_owned())).unwrap_or_default()
        };
        let flags = value("flags");
        let has = |flag: &str| flags.split(' ').any(|known| known == flag);
        let vectors = ["avx512f", "avx2", "sse2"].into_iter().find(|flag| has(flag)).unwrap_or("unknown");
        Self {
            cpu: value("model name"),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            vectors: vectors.to_owned(),
            peers: peers.map(|peers| peers.versions.clone()).unwrap_or_default(),
        }
    }
}

/// Peak resident memory of this process since the last call [bytes]; `None` where the system does not tell.
pub fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    // Starts the next peak; where that is not allowed the peaks only grow.
    let _allowed = std::fs::write("/proc/self/clear_refs", "5");
    Some(1024.0 * kilobytes)
}

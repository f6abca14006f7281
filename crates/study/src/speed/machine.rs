//! Machine on which was measured.

use crate::peers::Peers;
use serde::{Deserialize, Serialize};

/// The machine and the programs of a run.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Machine {
    pub(crate) cpu: String,
    pub(crate) cores: usize,
    pub(crate) vectors: String,
    pub(crate) peers: String,
}

impl Machine {
    pub(crate) fn read(peers: Option<&Peers>) -> Self {
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
pub(crate) fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    // Starts the next peak; where that is not allowed the peaks only grow.
    let _allowed = std::fs::write("/proc/self/clear_refs", "5");
    Some(1024.0 * kilobytes)
}

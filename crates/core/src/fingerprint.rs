//! Fingerprints of files.

/// Fingerprint of bytes, the 64-bit FNV-1a hash (Fowler, Noll, Vo).
///
/// It is stable across versions and machines, and guards against mistakes, not against malice.
#[derive(Clone, Debug)]
pub struct Fingerprint(u64);

impl Fingerprint {
    /// Fingerprint of no bytes, the offset basis of FNV-1a.
    #[must_use]
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Adds bytes; the multiplier is the prime of FNV-1a.
    pub fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// Fingerprint of all bytes so far.
    #[must_use]
    pub fn value(&self) -> u64 {
        self.0
    }
}

impl Default for Fingerprint {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fingerprints_are_those_of_its_authors() {
        // Test vectors of the authors: http://www.isthe.com/chongo/tech/comp/fnv, section "FNV test vectors".
        for (text, expected) in
            [("", 0xcbf2_9ce4_8422_2325), ("a", 0xaf63_dc4c_8601_ec8c), ("foobar", 0x8594_4171_f739_67e8)]
        {
            let mut print = Fingerprint::new();
            print.add(text.as_bytes());
            assert_eq!(print.value(), expected, "{text}");
        }
    }
}

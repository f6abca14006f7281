//! A message as one string of bytes, for ways that are no shared memory.

use crate::error::WireError;
use crate::header::{Block64, Header};
use crate::layout::{Layout, Sections};
use std::mem::{MaybeUninit, align_of, size_of};

/// Blocks that a header takes.
const HEADER_BLOCKS: usize = size_of::<Header>().div_ceil(size_of::<Block64>());

/// A message on its way to another machine of the same kind: its header, on blocks of its own, then its
/// payload.
#[derive(Clone, Debug)]
pub struct Letter {
    blocks: Vec<Block64>,
}

impl Letter {
    /// Writes a message: `write` fills its sections, as for shared memory.
    ///
    /// # Errors
    /// Those of `write`.
    pub fn write(
        layout: &Layout,
        write: impl FnOnce(&mut [MaybeUninit<Block64>]) -> Result<(), WireError>,
    ) -> Result<Self, WireError> {
        let mut payload = vec![MaybeUninit::new(Block64 { words: [0; 8] }); layout.blocks()];
        write(&mut payload)?;
        // SAFETY: every block was set to zero before `write` saw it.
        let payload =
            unsafe { std::slice::from_raw_parts(payload.as_ptr().cast::<Block64>(), payload.len()) };
        Ok(Self::new(layout.header(), payload))
    }

    /// Copies a message.
    #[must_use]
    pub fn new(header: &Header, payload: &[Block64]) -> Self {
        let mut blocks = vec![Block64 { words: [0; 8] }; HEADER_BLOCKS];
        // SAFETY: the blocks are as large as a header and aligned to more than it; it has no padding.
        unsafe { blocks.as_mut_ptr().cast::<Header>().write(*header) };
        blocks.extend_from_slice(payload);
        Self { blocks }
    }

    /// Reads what arrived.
    ///
    /// # Errors
    /// Bytes that are no whole number of blocks, or too few for a header.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, WireError> {
        let count = bytes.len() / size_of::<Block64>();
        if !bytes.len().is_multiple_of(size_of::<Block64>()) || count < HEADER_BLOCKS {
            return Err(WireError::Letter(bytes.len()));
        }
        let mut blocks = vec![Block64 { words: [0; 8] }; count];
        // SAFETY: the blocks have room for the bytes, and any bytes are a block.
        unsafe { blocks.as_mut_ptr().cast::<u8>().copy_from_nonoverlapping(bytes.as_ptr(), bytes.len()) };
        Ok(Self { blocks })
    }

    /// The message as bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        let count = size_of_val(self.blocks.as_slice());
        // SAFETY: blocks have no padding.
        unsafe { std::slice::from_raw_parts(self.blocks.as_ptr().cast::<u8>(), count) }
    }

    /// Header of the message.
    #[must_use]
    pub fn header(&self) -> &Header {
        // SAFETY: the first blocks were written as a header, or are bytes, of which any are one.
        unsafe { &*self.blocks.as_ptr().cast::<Header>() }
    }

    /// Payload of the message.
    #[must_use]
    pub fn payload(&self) -> &[Block64] {
        &self.blocks[HEADER_BLOCKS..]
    }

    /// Sections of the message.
    #[must_use]
    pub fn sections(&self) -> Sections<'_> {
        Sections::new(self.header(), self.payload())
    }
}

const _: () = assert!(align_of::<Header>() <= align_of::<Block64>());

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MessageKind, Section};

    #[test]
    fn a_message_is_the_same_behind_its_way_as_bytes() {
        let layout = Layout::new(Header::new(MessageKind::Charges, 7, 3)).with::<f64>(Section::Charges, 11);
        let letter = Letter::write(&layout, |payload| {
            layout.section_mut::<f64>(payload, Section::Charges)?[10] = 9.0;
            Ok(())
        });
        let letter = letter.unwrap();
        // A place that is aligned to nothing.
        let mut bytes = vec![0_u8];
        bytes.extend_from_slice(letter.bytes());
        let arrived = Letter::from_bytes(&bytes[1..]).unwrap();
        assert_eq!(arrived.header(), layout.header());
        assert_eq!(arrived.payload(), letter.payload());
        let charges = arrived.sections().exactly::<f64>(Section::Charges, 11).unwrap();
        assert_eq!((charges[0], charges[10]), (0.0, 9.0));
    }

    #[test]
    fn bytes_that_are_no_message_are_refused() {
        for count in [0, 64, 575, 577] {
            assert_eq!(Letter::from_bytes(&vec![1; count]).unwrap_err(), WireError::Letter(count));
        }
        let nonsense = Letter::from_bytes(&[255; 640]).unwrap();
        assert!(nonsense.header().check(7).is_err());
        assert!(nonsense.sections().get::<f64>(Section::Charges).is_err());
    }
}

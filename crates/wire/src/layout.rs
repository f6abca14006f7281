//! Writing and reading a payload's sections; nothing that is read is trusted.

use crate::error::WireError;
use crate::header::{Block64, Header, MOST_SECTIONS, SectionEntry};
use crate::section::Section;
use std::mem::{MaybeUninit, size_of};

/// Element of a section: any bit pattern is a value.
///
/// # Safety
/// Implementors have no padding and no invalid bit patterns, and an alignment of at most 64.
pub unsafe trait Element: Copy {}
// SAFETY: plain numbers, and arrays of them.
unsafe impl Element for f64 {}
// SAFETY: as above.
unsafe impl Element for u64 {}
// SAFETY: as above.
unsafe impl Element for i64 {}
// SAFETY: as above.
unsafe impl Element for u32 {}
// SAFETY: as above.
unsafe impl Element for u8 {}
// SAFETY: as above.
unsafe impl<const N: usize> Element for [f64; N] {}

/// Sections in the making.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    header: Header,
    blocks: usize,
}

impl Layout {
    /// Starts a layout without sections.
    #[must_use]
    pub fn new(header: Header) -> Self {
        Self { header: Header { section_count: 0, ..header }, blocks: 0 }
    }

    /// Adds a section of `count` elements.
    ///
    /// # Panics
    /// With more sections than a header has room for: our own bug.
    #[must_use]
    pub fn with<T: Element>(mut self, section: Section, count: usize) -> Self {
        let place = self.header.section_count as usize;
        assert!(place < MOST_SECTIONS, "a header has room for {MOST_SECTIONS} sections");
        self.header.sections[place] = SectionEntry {
            section: section as u32,
            element: size_of::<T>() as u32,
            count: count as u64,
            first_block: self.blocks as u64,
        };
        self.header.section_count += 1;
        self.blocks += (count * size_of::<T>()).div_ceil(size_of::<Block64>());
        self
    }

    /// The header with all sections.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Number of blocks of the payload; never 0.
    #[must_use]
    pub fn blocks(&self) -> usize {
        self.blocks.max(1)
    }

    /// Gives the memory of a section in a payload, set to zero.
    ///
    /// # Errors
    /// A section that was not added, or elements of another size.
    pub fn section_mut<'a, T: Element>(
        &self,
        payload: &'a mut [MaybeUninit<Block64>],
        section: Section,
    ) -> Result<&'a mut [T], WireError> {
        let (count, first_block) = find::<T>(&self.header, payload.len(), section)?;
        let blocks = (count * size_of::<T>()).div_ceil(size_of::<Block64>());
        let part = &mut payload[first_block..first_block + blocks];
        for block in &mut *part {
            block.write(Block64 { words: [0; 8] });
        }
        // SAFETY: the blocks are initialised just now, hold `count` elements by `find`, and are aligned to 64
        // bytes.
        Ok(unsafe { std::slice::from_raw_parts_mut(part.as_mut_ptr().cast::<T>(), count) })
    }
}

/// Sections of a message received.
#[derive(Clone, Copy, Debug)]
pub struct Sections<'a> {
    header: &'a Header,
    payload: &'a [Block64],
}

impl<'a> Sections<'a> {
    /// Reads a header and the payload that belongs to it.
    #[must_use]
    pub fn new(header: &'a Header, payload: &'a [Block64]) -> Self {
        Self { header, payload }
    }

    /// Gives a section in place.
    ///
    /// # Errors
    /// A section that is not there, has elements of another size or reaches beyond the payload.
    pub fn get<T: Element>(&self, section: Section) -> Result<&'a [T], WireError> {
        let (count, first_block) = find::<T>(self.header, self.payload.len(), section)?;
        let part = &self.payload[first_block..];
        // SAFETY: the blocks from the first on hold `count` elements by `find`, any bit pattern is a value,
        // and blocks are aligned to 64 bytes.
        Ok(unsafe { std::slice::from_raw_parts(part.as_ptr().cast::<T>(), count) })
    }

    /// Gives a section of so many elements, in place.
    ///
    /// # Errors
    /// The errors of [`Self::get`], and another number of elements.
    pub fn exactly<T: Element>(&self, section: Section, count: usize) -> Result<&'a [T], WireError> {
        let found = self.get::<T>(section)?;
        if found.len() != count {
            return Err(WireError::Count { section, theirs: found.len(), ours: count });
        }
        Ok(found)
    }

    /// Gives the only element of a section, in place.
    ///
    /// # Errors
    /// The errors of [`Self::get`], and another number of elements.
    pub fn one<T: Element>(&self, section: Section) -> Result<&'a T, WireError> {
        match self.exactly::<T>(section, 1)? {
            [element] => Ok(element),
            several => Err(WireError::Count { section, theirs: several.len(), ours: 1 }),
        }
    }

    /// Gives the text of a message; empty where it has none.
    #[must_use]
    pub fn text(&self) -> String {
        self.get::<u8>(Section::Text)
            .map_or_else(|_| String::new(), |text| String::from_utf8_lossy(text).into_owned())
    }
}

/// Finds the count and the first block of a section that lies within so many blocks.
fn find<T: Element>(header: &Header, blocks: usize, section: Section) -> Result<(usize, usize), WireError> {
    let known = &header.sections[..(header.section_count as usize).min(MOST_SECTIONS)];
    let entry =
        known.iter().find(|entry| entry.section == section as u32).ok_or(WireError::Missing(section))?;
    let SectionEntry { element, count, first_block, .. } = *entry;
    if element as usize != size_of::<T>() {
        return Err(WireError::Element { section, theirs: element, ours: size_of::<T>() });
    }
    let last = count
        .checked_mul(u64::from(element))
        .map(|bytes| bytes.div_ceil(size_of::<Block64>() as u64))
        .and_then(|needed| needed.checked_add(first_block));
    match last {
        Some(last) if last <= blocks as u64 => Ok((count as usize, first_block as usize)),
        _ => Err(WireError::Bounds { section, count, first_block, blocks }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MessageKind, PROTOCOL_VERSION};

    fn message() -> (Header, Vec<Block64>) {
        let header = Header::new(MessageKind::Charges, 7, 3);
        let layout =
            Layout::new(header).with::<[f64; 3]>(Section::Positions, 5).with::<f64>(Section::Charges, 5);
        let mut payload = vec![MaybeUninit::uninit(); layout.blocks()];
        layout.section_mut::<[f64; 3]>(&mut payload, Section::Positions).unwrap()[4] = [1.0, 2.0, 3.0];
        layout.section_mut::<f64>(&mut payload, Section::Charges).unwrap()[4] = 9.0;
        // SAFETY: both sections cover every block.
        let payload = payload.into_iter().map(|block| unsafe { block.assume_init() }).collect();
        (*layout.header(), payload)
    }

    #[test]
    fn sections_come_back_as_they_were_written_and_begin_on_blocks() {
        let (header, payload) = message();
        assert_eq!(payload.len(), 3);
        let sections = Sections::new(&header, &payload);
        assert_eq!(sections.get::<[f64; 3]>(Section::Positions).unwrap()[4], [1.0, 2.0, 3.0]);
        assert_eq!(sections.exactly::<f64>(Section::Charges, 5).unwrap()[4], 9.0);
        assert_eq!(sections.text(), "");
        assert_eq!(header.check(7), Ok(MessageKind::Charges));
    }

    #[test]
    fn what_does_not_fit_is_refused_by_name() {
        let (mut header, payload) = message();
        let error =
            |header: &Header| Sections::new(header, &payload).get::<f64>(Section::Charges).unwrap_err();
        assert_eq!(
            Sections::new(&header, &payload).get::<f64>(Section::Potential),
            Err(WireError::Missing(Section::Potential))
        );
        assert!(Sections::new(&header, &payload).get::<u8>(Section::Charges).is_err());
        for (count, first_block) in [(6, 3), (u64::MAX, 0), (1, u64::MAX), (1_000_000, 0)] {
            (header.sections[1].count, header.sections[1].first_block) = (count, first_block);
            assert!(matches!(error(&header), WireError::Bounds { .. }), "{count} {first_block}");
        }
        header.section_count = u64::MAX;
        assert!(matches!(error(&header), WireError::Bounds { .. }));
        header.version = PROTOCOL_VERSION + 1;
        let (theirs, ours) = (PROTOCOL_VERSION + 1, PROTOCOL_VERSION);
        let said = format!("version {theirs} of the protocol, this program {ours}");
        assert!(header.check(7).unwrap_err().to_string().contains(&said));
        let header = Header { kind: 99, version: PROTOCOL_VERSION, ..header };
        assert_eq!((header.check(7), header.check(8).is_err()), (Err(WireError::Kind(99)), true));
    }
}

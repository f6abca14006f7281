//! Tags of an XML text, as far as VTK's files need them.

/// Tag with the text behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tag<'t> {
    /// Name; that of a closing tag begins with `/`.
    pub(super) name: &'t str,
    /// Attributes as they stand.
    attributes: &'t str,
    /// Text up to the next tag.
    pub(super) text: &'t str,
}

impl<'t> Tag<'t> {
    /// Value of an attribute.
    pub(super) fn attribute(&self, name: &str) -> Option<&'t str> {
        let mut rest = self.attributes;
        loop {
            let (key, after) = rest.split_once('=')?;
            let after = after.trim_start();
            let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
            let (value, behind) = after[1..].split_once(quote)?;
            if key.trim() == name {
                return Some(value);
            }
            rest = behind;
        }
    }
}

/// Tags of a text, in their order; comments and declarations are passed over.
pub(super) struct Tags<'t>(&'t str);

impl<'t> Tags<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self(text)
    }
}

impl<'t> Iterator for Tags<'t> {
    type Item = Tag<'t>;

    fn next(&mut self) -> Option<Tag<'t>> {
        loop {
            let (_, rest) = self.0.split_once('<')?;
            if let Some(comment) = rest.strip_prefix("!--") {
                self.0 = comment.split_once("-->")?.1;
                continue;
            }
            let (inside, behind) = rest.split_once('>')?;
            self.0 = behind;
            if inside.starts_with(['?', '!']) {
                continue;
            }
            let inside = inside.strip_suffix('/').unwrap_or(inside);
            let (name, attributes) =
                inside.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((inside, ""));
            let text = behind.split('<').next().unwrap_or_default();
            return Some(Tag { name, attributes, text });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_have_attributes_in_either_quotes_and_their_text() {
        let text = "<?xml v=\"1\"?><!-- <no/> --><A b = 'c d'\n e=\"f\"> 1 2 <B/></A>";
        let tags: Vec<Tag<'_>> = Tags::new(text).collect();
        assert_eq!(tags.iter().map(|tag| tag.name).collect::<Vec<_>>(), ["A", "B", "/A"]);
        assert_eq!((tags[0].attribute("b"), tags[0].attribute("e")), (Some("c d"), Some("f")));
        assert_eq!((tags[0].attribute("x"), tags[0].text), (None, " 1 2 "));
    }
}

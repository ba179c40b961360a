//! Arrays of numbers with a JSON document that says what they are, in one piece.
//!
//! ```text
//! u32       length of the document, in bytes, little-endian like all that follows
//! document  { "meta": …, "arrays": { name: { "type": "f32"|"u32"|"u8", "at", "length" } } }, padded with spaces
//! arrays    each from a multiple of 8 on; "at" counts from the end of the document
//! ```

use serde_json::{Map, Value, json};

/// Arrays begin at multiples of this, so that a browser can look at them in place.
const ALIGNMENT: usize = 8;

/// See the [module](self).
#[derive(Clone, Debug)]
pub(crate) struct Container {
    meta: Value,
    arrays: Map<String, Value>,
    data: Vec<u8>,
}

impl Container {
    pub(crate) fn new(meta: Value) -> Self {
        Self { meta, arrays: Map::new(), data: Vec::new() }
    }

    pub(crate) fn floats(self, name: &str, values: &[f32]) -> Self {
        self.array((name, "f32"), values.len(), values.iter().flat_map(|value| value.to_le_bytes()))
    }

    pub(crate) fn words(self, name: &str, values: &[u32]) -> Self {
        self.array((name, "u32"), values.len(), values.iter().flat_map(|value| value.to_le_bytes()))
    }

    pub(crate) fn bytes(self, name: &str, values: &[u8]) -> Self {
        self.array((name, "u8"), values.len(), values.iter().copied())
    }

    fn array(mut self, (name, kind): (&str, &str), length: usize, bytes: impl Iterator<Item = u8>) -> Self {
        self.arrays.insert(name.to_owned(), json!({ "type": kind, "at": self.data.len(), "length": length }));
        self.data.extend(bytes);
        self.data.resize(self.data.len().next_multiple_of(ALIGNMENT), 0);
        self
    }

    /// All of it as bytes.
    pub(crate) fn finish(self) -> Vec<u8> {
        let mut document = json!({ "meta": self.meta, "arrays": self.arrays }).to_string().into_bytes();
        let begin = (4 + document.len()).next_multiple_of(ALIGNMENT);
        document.resize(begin - 4, b' ');
        let mut bytes = Vec::with_capacity(begin + self.data.len());
        bytes.extend((document.len() as u32).to_le_bytes());
        bytes.extend(document);
        bytes.extend(self.data);
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_where_the_document_says() {
        let container = Container::new(json!("ü")).bytes("a", &[7]).words("b", &[5, 6]).floats("c", &[1.5]);
        let bytes = container.finish();
        let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
        let document: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
        assert_eq!(document["meta"], "ü");
        let at = |name: &str| 4 + length + document["arrays"][name]["at"].as_u64().unwrap() as usize;
        assert!(["a", "b", "c"].iter().all(|name| at(name) % ALIGNMENT == 0));
        assert_eq!(bytes[at("a")], 7);
        assert_eq!(bytes[at("b") + 4..at("b") + 8], 6_u32.to_le_bytes());
        assert_eq!(bytes[at("c")..at("c") + 4], 1.5_f32.to_le_bytes());
    }
}

//! Numbers with their nouns, for messages.

/// A number with its noun: `1 face`, `2 faces`.
pub fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// The same behind "there": `is 1 face`, `are 2 faces`.
pub fn are(count: usize, one: &str, many: &str) -> String {
    format!("{} {}", if count == 1 { "is" } else { "are" }, counted(count, one, many))
}

#[cfg(test)]
mod tests {
    use crate::distortion::DistortionError;
    use crate::surface::{ModelError, PrepareError};

    #[test]
    fn one_is_told_of_in_the_singular() {
        let told = |error: &dyn std::error::Error| error.to_string();
        assert_eq!(
            told(&ModelError::FewCorners { face: 2, corners: 1 }),
            "face 2 has 1 corner, but a face needs at least 3"
        );
        assert_eq!(
            told(&PrepareError::NoArea { faces: 1 }),
            "the mesh has no area: its only face is a point or a line"
        );
        let lacking = told(&DistortionError::TextureCount { found: 1, corners: 3 });
        assert_eq!(lacking, "there is 1 texture coordinate for 3 corners of faces");
        assert_eq!(
            told(&DistortionError::Count { triangles: 1, uv: 2 }),
            "there is 1 triangle but texture coordinates for 2"
        );
    }
}

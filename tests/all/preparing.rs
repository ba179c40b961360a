//! The laws of making surfaces of anything.

use proptest::prelude::*;
use tests::properties;

use crate::{bytes, cases};

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn any_polygons_become_sound_surfaces(bytes in bytes(600)) {
        properties::preparing(&bytes);
    }

    #[test]
    fn any_surface_gets_even_triangles(bytes in bytes(200)) {
        properties::refinement(&bytes);
    }
}

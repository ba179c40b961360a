//! The laws of reading and writing.

use proptest::prelude::*;
use tests::properties;

use crate::{bytes, cases};

/// Lines that look like those of an OBJ.
fn obj_line() -> impl Strategy<Value = String> {
    prop_oneof![
        "v( -?[0-9]{1,2}(\\.[0-9]{1,3})?(e-?[0-9]{1,3})?){3,7}",
        "vt( -?[0-9]\\.[0-9]{1,3}){1,3}",
        "f( -?[0-9](/-?[0-9]?(/-?[0-9]?)?)?){1,5} ?\\\\?",
        "[gosl#]( [a-z0-9]{0,4}){0,3}",
        "(usemtl|mtllib|curv|p|vn|s) ?[ -~]{0,12}",
        "[ -~\\t]{0,20}",
    ]
}

proptest! {
    #![proptest_config(cases(512))]

    #[test]
    fn any_bytes_are_read_or_refused(bytes in bytes(300), format in 0..5usize) {
        properties::reading(&bytes, ["a.obj", "a.off", "a.ply", "a.stl", "a.glb"][format]);
    }

    #[test]
    fn what_looks_like_an_obj_is_read_or_refused_and_given_back(
        lines in prop::collection::vec(obj_line(), 0..24),
        end in prop_oneof![Just("\n"), Just("\r\n"), Just("\r")],
    ) {
        let text = format!("v 0 0 0{end}v 1 0 0{end}v 0 1 0{end}v 0 0 1{end}f 1 2 3{end}{}", lines.join(end));
        properties::reading(text.as_bytes(), "a.obj");
        properties::obj_is_given_back(text.as_bytes());
    }
}

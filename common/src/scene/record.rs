//! Reading of all fields of a type before the first faulty one is looked at.

/// The type with these fields; `None` if one of them is. All are read, so that every fault is recorded; a field may depend on those
/// before it, as options.
macro_rules! record {
    ($($Type:ident)::+ { $($field:ident: $read:expr),* $(,)? }) => {{
        $(let $field = $read;)*
        (|| Some($($Type)::+ { $($field: $field?,)* }))()
    }};
}
pub(super) use record;

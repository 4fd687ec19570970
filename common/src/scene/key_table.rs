//! Tables of the keys of loads and outputs: one row for each kind, with its word in a scene, its keys with the form in which each is
//! written, and the sentence that explains it. `elements!` declares the type of an element from its table; its reader (`key_reading`), its
//! explanation (`explained`), the rows of reports, the schema of scenes and the page about their language follow from the same rows.

use super::context::Range;
use super::quantity::Kind;
use super::values::{
    Attachment, Curve, ErrorMeasure, HeldInput, ImpactMeasure, Over, SignedBody, WearQuantity,
};

/// A row of a table: one kind of element.
#[derive(Debug)]
pub struct ElementKind<T: 'static> {
    /// Name of its variant.
    pub name: &'static str,
    /// Its words in a scene, each with what depends on the word; none for a kind that is not read from a row.
    pub words: &'static [(&'static str, T)],
    /// What it is.
    pub about: &'static str,
    /// Its keys, in the order in which they are read.
    pub keys: &'static [Key],
    /// One line that explains an element of this kind, with keys in braces in the places of their values.
    pub sentence: &'static str,
}

/// A key of an element.
#[derive(Debug)]
pub struct Key {
    /// Name of the key.
    pub name: &'static str,
    /// How its value is written.
    pub form: Form,
    /// What it is, and its unit.
    pub about: &'static str,
}

/// How the value of a key is written in a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// The unique name of the element.
    Name,
    /// A place `{ body, point }`.
    Place,
    /// A place on a free body.
    FreePlace,
    /// Name of a body.
    Body,
    /// Name of a free body.
    FreeBody,
    /// Name of a driven body.
    DrivenBody,
    /// A body `{ body, sign, label }`.
    SignedBody,
    /// A direction `[x, y]` of any length but zero; of unit length when it is read.
    Direction,
    /// A pair `[x, y]` of quantities.
    Pair(Kind),
    /// A required quantity.
    Number(Kind, Range),
    /// A quantity with a default [SI].
    NumberOr(Kind, Range, f64),
    /// A curve over time or an angle.
    Curve(Kind),
    /// An optional curve that an output should follow.
    Wanted(Kind),
    /// The optional curves `wanted_x` and `wanted_y`.
    WantedPoint,
    /// An optional curve of a plain number >= 0.
    Factor,
    /// Names of joints, by default all.
    Joints,
    /// Names of joints with clearance, by default all of them.
    StruckJoints,
    /// Names of joints that wear, by default all that have the quantity of the wear.
    WornJoints,
    /// The quantity of the wear that the word of the element states.
    WearQuantity,
    /// A word of [`ErrorMeasure`].
    ErrorMeasure,
    /// A word of [`ImpactMeasure`].
    ImpactMeasure,
    /// `input` and `input_angle`: where the drives are held.
    Held,
    /// An optional number of cycles.
    Cycles,
    /// One of these words, the first of them by default.
    Word(&'static [&'static str]),
    /// Read elsewhere, not from a row of the table.
    Elsewhere,
}

/// Declares [`Value`] with the types of values that keys have.
macro_rules! values {
    ($($(#[doc = $doc:literal])* $variant:ident($type:ty),)*) => {
        /// The value of a key of an element.
        #[derive(Debug, Clone, PartialEq)]
        pub enum Value {
            $($(#[doc = $doc])* $variant($type),)*
        }

        $(
            impl From<$type> for Value {
                fn from(value: $type) -> Self {
                    Value::$variant(value)
                }
            }

            impl From<Value> for $type {
                fn from(value: Value) -> Self {
                    match value {
                        Value::$variant(value) => value,
                        other => panic!("the type and the form of a key differ: {other:?}"),
                    }
                }
            }
        )*
    };
}

values! {
    /// A place on a body.
    Place(Attachment),
    /// Index of a body.
    Body(usize),
    /// A body with a sign.
    SignedBody(SignedBody),
    /// A direction, or a pair of quantities [SI].
    Pair([f64; 2]),
    /// A quantity [SI].
    Number(f64),
    /// A curve over time or an angle.
    Curve(Curve),
    /// An optional curve.
    MaybeCurve(Option<Curve>),
    /// Optional curves of the coordinates x and y.
    TwoCurves([Option<Curve>; 2]),
    /// Indices of joints.
    Joints(Vec<usize>),
    /// A quantity of the wear.
    WearQuantity(WearQuantity),
    /// A measure of an error.
    ErrorMeasure(ErrorMeasure),
    /// A measure of impacts.
    ImpactMeasure(ImpactMeasure),
    /// Where the drives are held.
    Held(Option<HeldInput>),
    /// A text of any kind.
    Text(String),
    /// True or false.
    Flag(bool),
}

impl Value {
    /// The body that the value refers to.
    pub fn body(&self) -> Option<usize> {
        match self {
            Value::Place(place) => Some(place.body),
            Value::Body(body) => Some(*body),
            Value::SignedBody(signed) => Some(signed.body),
            Value::Curve(curve) | Value::MaybeCurve(Some(curve)) => match curve.over {
                Over::Angle(body) => Some(body),
                Over::Time => None,
            },
            _ => None,
        }
    }

    /// The curves of the value at `key`, each with the key that it has in a scene.
    pub fn curves(&self, key: &'static str) -> Vec<(&'static str, &Curve)> {
        match self {
            Value::Curve(curve) | Value::MaybeCurve(Some(curve)) => vec![(key, curve)],
            Value::TwoCurves(curves) => {
                let keys = ["wanted_x", "wanted_y"].into_iter();
                keys.zip(curves).filter_map(|(key, curve)| Some((key, curve.as_ref()?))).collect()
            }
            _ => vec![],
        }
    }
}

/// Declares the type of an element from the table of its kinds.
///
/// A row is `"word" (what depends on the word) => Variant { key: type = form, ... } "sentence"`; doc comments become those of the type and the
/// texts of the table.
macro_rules! elements {
    (
        $(#[doc = $about:literal])*
        pub enum $Element:ident by $Tag:ty;
        $(
            $(#[doc = $doc:literal])*
            $($word:literal ($tag:expr)),* => $Variant:ident {
                $($(#[doc = $key_doc:literal])* $key:ident: $type:ty = $form:expr,)*
            }
            $sentence:literal
        )*
    ) => {
        $(#[doc = $about])*
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        pub enum $Element {
            $($(#[doc = $doc])* $Variant {
                $($(#[doc = $key_doc])* $key: $type,)*
            },)*
        }

        impl $Element {
            /// Every kind with its words and keys.
            pub const KINDS: &'static [ElementKind<$Tag>] = &[$(ElementKind {
                name: stringify!($Variant),
                words: &[$(($word, $tag)),*],
                about: concat!($($doc),*),
                keys: &[$(Key { name: stringify!($key), form: $form, about: concat!($($key_doc),*) }),*],
                sentence: $sentence,
            }),*];

            /// The element of a kind with the values of its keys.
            pub(super) fn from_values(kind: &str, values: Vec<Value>) -> Option<Self> {
                let mut values = values.into_iter();
                match kind {
                    $(stringify!($Variant) => Some($Element::$Variant {
                        $($key: values.next()?.into(),)*
                    }),)*
                    _ => None,
                }
            }

            /// The row of its kind.
            pub fn kind(&self) -> &'static ElementKind<$Tag> {
                let name = match self {
                    $($Element::$Variant { .. } => stringify!($Variant),)*
                };
                let of_name = Self::KINDS.iter().find(|kind| kind.name == name);
                of_name.expect("every kind has a row")
            }

            /// Its keys with their values.
            pub fn values(&self) -> Vec<(&'static Key, Value)> {
                let values = match self {
                    $($Element::$Variant { $($key,)* .. } => vec![$(Value::from(Clone::clone($key))),*],)*
                };
                self.kind().keys.iter().zip(values).collect()
            }

            /// Changes its values.
            pub fn change(&mut self, mut change: impl FnMut(&mut Value)) {
                let mut values: Vec<Value> = self.values().into_iter().map(|(_, value)| value).collect();
                values.iter_mut().for_each(&mut change);
                *self = Self::from_values(self.kind().name, values).expect("a value for every key");
            }
        }
    };
}
pub(super) use elements;

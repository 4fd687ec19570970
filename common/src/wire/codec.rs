//! Encodes and decodes messages: the only module that uses the serialisation format (bincode).
//!
//! ```text
//! byte  0..4   magic "HNGW"
//!       4..6   protocol version, little endian
//!       6      kind of message
//!       7      zero
//!       8..12  length of the payload, little endian
//!      12..    payload
//! ```
//!
//! Header and length are checked before the payload is read. Memory for decoding is bounded by the size of the received
//! frame, so that a forged length inside the payload allocates nothing. Trailing bytes and numbers that are not finite
//! are refused.

use super::PROTOCOL_VERSION;
use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

/// Largest payload of a message [bytes]. An outcome with a first cycle of 2000 points takes about 200 kB.
pub const MAX_PAYLOAD: usize = 16 << 20;

/// Zenoh setting `transport/link/rx/max_message_size`: the largest frame and its Zenoh header [bytes]. Zenoh's default is
/// 1 GiB, which a hostile peer could make it allocate.
pub const MAX_MESSAGE: &str = "16908288";

/// Bytes before the payload.
pub const HEADER: usize = 12;

const MAGIC: [u8; 4] = *b"HNGW";

/// Memory limit of the decoder [bytes]. It counts each number at its full width, at most eight bytes per encoded byte;
/// the margin is for the last one.
const fn decode_limit(payload: usize) -> usize {
    8 * payload + 64
}

/// Upper sizes of payloads with a common memory limit of the decoder [bytes].
const SMALL: usize = 1 << 10;
const MEDIUM: usize = 64 << 10;
const LARGE: usize = 1 << 20;

/// Reasons why a frame cannot be decoded or a message cannot be encoded.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum WireError {
    /// The bytes are not a frame of this program.
    #[error("not a message of this program")]
    NotOurs,
    /// The other side has another protocol version.
    #[error("the other side uses protocol version {theirs}, this side version {ours}")]
    OtherVersion {
        /// Version in the frame.
        theirs: u16,
        /// Version of this program, [`PROTOCOL_VERSION`].
        ours: u16,
    },
    /// The message has another kind than expected.
    #[error("expected a {expected}, found a message of kind {found}")]
    OtherKind {
        /// Name of the expected message.
        expected: &'static str,
        /// Number of the kind found.
        found: u8,
    },
    /// The length in the header differs from the number of bytes received.
    #[error("the frame states a payload of {stated} bytes and has {found}")]
    Length {
        /// Length in the header [bytes].
        stated: usize,
        /// Length received [bytes].
        found: usize,
    },
    /// The message exceeds [`MAX_PAYLOAD`]. Holds the size of the payload [bytes].
    #[error("a message of {0} bytes is larger than the limit of {MAX_PAYLOAD}")]
    TooLarge(usize),
    /// The payload cannot be decoded.
    #[error("malformed {message}: {reason}")]
    Malformed {
        /// Name of the message.
        message: &'static str,
        /// Error of the decoder.
        reason: String,
    },
    /// A number is NaN or infinite. Holds the name of the quantity.
    #[error("{0} is not finite")]
    NotFinite(String),
    /// A setting of the accuracy that no name stands for: it could exhaust the memory of a worker, or its time. Holds the name of the setting.
    #[error("the accuracy setting {0} is out of its range")]
    OutOfRange(&'static str),
    /// The name of a worker is not allowed in a key.
    #[error("the worker's name is empty, too long or has characters other than letters, digits, - _ .")]
    BadWorkerName,
}

/// A message or a part of one as bytes. Written out for each type beside its definition, by `encoded!`, so that its encoder and decoder are
/// compiled once, here, and not in every crate that sends or receives it.
pub trait Encoded: Sized {
    /// Appends the encoded value; returns its size [bytes].
    ///
    /// # Errors
    /// The error of the encoder.
    fn append_to(&self, frame: &mut Vec<u8>) -> Result<usize, String>;

    /// Encoded size [bytes].
    ///
    /// # Errors
    /// The error of the encoder.
    fn encoded_size(&self) -> Result<usize, String>;

    /// Decodes a value; returns it with the number of bytes read.
    ///
    /// # Errors
    /// The error of the decoder.
    fn read(payload: &[u8]) -> Result<(Self, usize), String>;
}

/// Implements [`Encoded`] for these types.
macro_rules! encoded {
    ($($kind:ty),+) => {
        $(impl $crate::wire::codec::Encoded for $kind {
            fn append_to(&self, frame: &mut Vec<u8>) -> Result<usize, String> {
                $crate::wire::codec::write(self, frame)
            }

            fn encoded_size(&self) -> Result<usize, String> {
                $crate::wire::codec::write(self, &mut std::io::sink())
            }

            fn read(payload: &[u8]) -> Result<(Self, usize), String> {
                $crate::wire::codec::read(payload)
            }
        })+
    };
}
pub(super) use encoded;

/// A message with its kind and its checks.
pub trait Message: Encoded {
    /// Number of the kind in the frame.
    const KIND: u8;
    /// Name of the kind, for messages to users.
    const NAME: &'static str;

    /// Checks the conditions that the types do not express.
    ///
    /// # Errors
    /// [`WireError::NotFinite`], [`WireError::OutOfRange`], [`WireError::BadWorkerName`].
    fn check(&self) -> Result<(), WireError>;
}

/// Encodes a message into a frame.
///
/// # Errors
/// Errors of [`Message::check`], [`WireError::TooLarge`], [`WireError::Malformed`].
pub fn encode<M: Message>(message: &M) -> Result<Vec<u8>, WireError> {
    message.check()?;
    let mut frame = vec![0; HEADER];
    frame[..4].copy_from_slice(&MAGIC);
    frame[4..6].copy_from_slice(&PROTOCOL_VERSION.to_le_bytes());
    frame[6] = M::KIND;
    let written = message.append_to(&mut frame).map_err(malformed::<M>)?;
    if written > MAX_PAYLOAD {
        return Err(WireError::TooLarge(written));
    }
    let length = u32::try_from(written).map_err(|_| WireError::TooLarge(written))?;
    frame[8..12].copy_from_slice(&length.to_le_bytes());
    Ok(frame)
}

/// Decodes the message of a frame.
///
/// # Errors
/// Any [`WireError`]; the version is checked first, right after the magic number.
pub fn decode<M: Message>(frame: &[u8]) -> Result<M, WireError> {
    let frame = frame.split_first_chunk::<HEADER>().filter(|(header, _)| header[..4] == MAGIC);
    let (header, payload) = frame.ok_or(WireError::NotOurs)?;
    let theirs = u16::from_le_bytes([header[4], header[5]]);
    if theirs != PROTOCOL_VERSION {
        return Err(WireError::OtherVersion { theirs, ours: PROTOCOL_VERSION });
    }
    if header[6] != M::KIND || header[7] != 0 {
        return Err(WireError::OtherKind { expected: M::NAME, found: header[6] });
    }
    let stated = u32::from_le_bytes([header[8], header[9], header[10], header[11]]) as usize;
    if stated != payload.len() {
        return Err(WireError::Length { stated, found: payload.len() });
    }
    if stated > MAX_PAYLOAD {
        return Err(WireError::TooLarge(stated));
    }
    let (message, consumed) = M::read(payload).map_err(malformed::<M>)?;
    if consumed != payload.len() {
        return Err(WireError::Length { stated: consumed, found: payload.len() });
    }
    message.check()?;
    Ok(message)
}

/// Writes an encoded value; returns its size [bytes].
///
/// # Errors
/// The error of the encoder.
pub(super) fn write<T: Serialize>(part: &T, to: &mut impl std::io::Write) -> Result<usize, String> {
    bincode::serde::encode_into_std_write(part, to, bincode::config::standard()).map_err(|e| e.to_string())
}

/// Decodes a value with a memory limit for the size of its bytes; returns it with the number of bytes read.
///
/// # Errors
/// The error of the decoder.
pub(super) fn read<T: DeserializeOwned>(payload: &[u8]) -> Result<(T, usize), String> {
    let decode = match payload.len() {
        size if size <= SMALL => limited::<T, { decode_limit(SMALL) }>,
        size if size <= MEDIUM => limited::<T, { decode_limit(MEDIUM) }>,
        size if size <= LARGE => limited::<T, { decode_limit(LARGE) }>,
        _ => limited::<T, { decode_limit(MAX_PAYLOAD) }>,
    };
    decode(payload)
}

/// Decodes with a memory limit of `LIMIT` bytes.
fn limited<T: DeserializeOwned, const LIMIT: usize>(payload: &[u8]) -> Result<(T, usize), String> {
    let limit = bincode::config::standard().with_limit::<LIMIT>();
    bincode::serde::decode_from_slice(payload, limit).map_err(|e| e.to_string())
}

fn malformed<M: Message>(reason: String) -> WireError {
    WireError::Malformed { message: M::NAME, reason }
}

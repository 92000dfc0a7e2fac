//! Serializes messages in the report as their texts, with settings as they are spelled at that time.
use chordal::budget::advice::Message;
use serde::{Serialize, Serializer};

/// One message.
pub(super) fn message_text<S: Serializer>(message: &Message, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(message)
}

/// One message or null.
pub(super) fn message_option<S: Serializer>(
    message: &Option<Message>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    message.as_deref().serialize(serializer)
}

/// A list of messages.
pub(super) fn message_texts<S: Serializer>(messages: &[Message], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(messages.iter().map(|message| &**message))
}

//! `RareValue`: a value that is nearly always the default, and takes memory only if it is not.
use crate::matrix::IDENTITY;
use serde_json::{Map, Value};
use std::ops::{Deref, DerefMut};
use std::sync::LazyLock;

/// A value that takes 8 bytes if it is the default of its type (the identity for a matrix, the empty map for
/// properties), and a box otherwise: a file of a megabyte may have three hundred thousand nodes.
///
/// It dereferences to the value. Mutable access allocates the box.
///
/// ```
/// use chordal_io::Node;
/// let mut node = Node::default();
/// assert_eq!(node.matrix[0], 1.0);
/// node.matrix[12] = 2.0;
/// let moved = *node.matrix;
/// assert_eq!(Node { matrix: moved.into(), ..Node::default() }, node);
/// ```
#[derive(Clone, Debug)]
pub struct RareValue<T>(Option<Box<T>>);

/// A type with a usual value.
pub trait UsualValue: Sized + 'static {
    /// The usual value.
    fn usual() -> &'static Self;
    /// Whether this is the usual value to the last bit.
    fn is_usual(&self) -> bool;
}

impl UsualValue for [f64; 16] {
    fn usual() -> &'static Self {
        &IDENTITY
    }

    fn is_usual(&self) -> bool {
        self.map(f64::to_bits) == IDENTITY.map(f64::to_bits)
    }
}

static NO_PROPERTIES: LazyLock<Map<String, Value>> = LazyLock::new(Map::new);

impl UsualValue for Map<String, Value> {
    fn usual() -> &'static Self {
        &NO_PROPERTIES
    }

    fn is_usual(&self) -> bool {
        self.is_empty()
    }
}

impl<T> Default for RareValue<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T: UsualValue> From<T> for RareValue<T> {
    fn from(value: T) -> Self {
        Self(if value.is_usual() { None } else { Some(Box::new(value)) })
    }
}

impl<T: UsualValue> Deref for RareValue<T> {
    type Target = T;
    fn deref(&self) -> &T {
        match &self.0 {
            Some(value) => value,
            None => T::usual(),
        }
    }
}

impl<T: UsualValue + Clone> DerefMut for RareValue<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.0.get_or_insert_with(|| Box::new(T::usual().clone()))
    }
}

impl<T: UsualValue + PartialEq> PartialEq for RareValue<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_usual_value_takes_no_box() {
        assert_eq!(size_of::<RareValue<[f64; 16]>>(), 8);
        assert!(RareValue::from(IDENTITY).0.is_none());
        let mut turned = IDENTITY;
        // −0 compares equal to 0, but makes another transform to the last bit.
        turned[1] = -0.0;
        let kept = RareValue::from(turned);
        assert!(kept.0.is_some() && kept[1].is_sign_negative());
        assert_eq!(kept, RareValue::default());
        turned[1] = 0.5;
        assert_ne!(RareValue::from(turned), RareValue::default());
    }
}

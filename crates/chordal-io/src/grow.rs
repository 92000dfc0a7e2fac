//! `grow`: lists whose length depends on a file. They grow in small steps as data is read, and never abort.
use crate::{FileLocation, ReadError};

/// The capacity that a list starts with.
const FIRST: usize = 64;
/// The same for lists of large items, many of which may be short.
const FIRST_LARGE: usize = 8;

/// The error of a list that does not fit into memory.
pub(crate) fn out_of_memory(rows: usize) -> ReadError {
    ReadError::new("out-of-memory", FileLocation::File, format!("no memory for more than {rows} rows"))
}

/// Appends to a list. It grows by half, so its capacity is at most 1.5 times the items that were read.
#[inline]
pub(crate) fn push<T>(list: &mut Vec<T>, item: T) -> Result<(), ReadError> {
    if list.len() == list.capacity() {
        grow(list, 1)?;
    }
    list.push(item);
    Ok(())
}

/// Appends to a list of large items. It grows by a quarter, so that the old and the new list together take at
/// most 2.25 times the items that were read while the list is moved.
#[inline]
pub(crate) fn push_large<T>(list: &mut Vec<T>, item: T) -> Result<(), ReadError> {
    if list.len() == list.capacity() {
        reserve_large(list, FIRST_LARGE)?;
    }
    list.push(item);
    Ok(())
}

/// Reserves `more` large items at once, and at least a quarter of the list.
pub(crate) fn reserve_large<T>(list: &mut Vec<T>, more: usize) -> Result<(), ReadError> {
    if list.capacity() - list.len() < more {
        list.try_reserve_exact(more.max(list.len() / 4)).map_err(|_| out_of_memory(list.len()))?;
    }
    Ok(())
}

/// Appends `more` copies of `item` to a list.
pub(crate) fn push_many<T: Clone>(list: &mut Vec<T>, item: T, more: usize) -> Result<(), ReadError> {
    if list.capacity() - list.len() < more {
        grow(list, more)?;
    }
    list.resize(list.len() + more, item);
    Ok(())
}

/// Appends all items of a list.
pub(crate) fn extend<T: Copy>(list: &mut Vec<T>, items: &[T]) -> Result<(), ReadError> {
    if list.capacity() - list.len() < items.len() {
        grow(list, items.len())?;
    }
    list.extend_from_slice(items);
    Ok(())
}

#[cold]
fn grow<T>(list: &mut Vec<T>, more: usize) -> Result<(), ReadError> {
    let step = more.max(list.len() / 2).max(FIRST);
    list.try_reserve_exact(step).map_err(|_| out_of_memory(list.len()))
}

/// An empty list with capacity for `rows` rows. The rows must be counted in the bytes of the file, not
/// declared by it.
pub(crate) fn with_room<T>(rows: usize) -> Result<Vec<T>, ReadError> {
    let mut list = Vec::new();
    list.try_reserve_exact(rows).map_err(|_| out_of_memory(rows))?;
    Ok(list)
}

//! `grow`: lists whose length a file decides. They grow with what was read, in small steps, and never abort.
use crate::{FileLocation, ReadError};

/// The capacity that a list starts with.
const FIRST: usize = 64;
/// The same for large items, of which there can be many short lists.
const FIRST_LARGE: usize = 8;

/// The error of a list that does not fit into memory.
pub(crate) fn out_of_memory(rows: usize) -> ReadError {
    ReadError::new("out-of-memory", FileLocation::File, format!("no memory for more than {rows} rows"))
}

/// Appends to a list. It grows by half, so it holds at most 1.5 times what was read.
#[inline]
pub(crate) fn push<T>(list: &mut Vec<T>, item: T) -> Result<(), ReadError> {
    if list.len() == list.capacity() {
        grow(list, 1)?;
    }
    list.push(item);
    Ok(())
}

/// Appends to a list of large items. It grows by a quarter, so that the old and the new list together are no
/// more than 2.25 times what was read while it moves.
#[inline]
pub(crate) fn push_large<T>(list: &mut Vec<T>, item: T) -> Result<(), ReadError> {
    if list.len() == list.capacity() {
        reserve_large(list, FIRST_LARGE)?;
    }
    list.push(item);
    Ok(())
}

/// Makes room for `more` large items at once, and for a quarter of the list at least.
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

/// An empty list with capacity for `rows` rows that were counted in the bytes of the file, never declared by
/// it.
pub(crate) fn with_room<T>(rows: usize) -> Result<Vec<T>, ReadError> {
    let mut list = Vec::new();
    list.try_reserve_exact(rows).map_err(|_| out_of_memory(rows))?;
    Ok(list)
}

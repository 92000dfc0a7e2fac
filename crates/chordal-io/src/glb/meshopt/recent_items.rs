//! `RecentItems`: the edges or vertices that triangles refer to by age.

/// The last sixteen items.
pub(super) struct RecentItems<T> {
    items: [Option<T>; 16],
    n_pushed: usize,
}

impl<T: Copy + PartialEq> RecentItems<T> {
    pub fn new() -> Self {
        Self { items: [None; 16], n_pushed: 0 }
    }

    pub fn push(&mut self, item: T) {
        self.items[self.n_pushed % 16] = Some(item);
        self.n_pushed += 1;
    }

    /// The item that was pushed `age` pushes before the newest, if there were so many.
    pub fn get(&self, age: u8) -> Option<T> {
        self.items[self.n_pushed.checked_sub(usize::from(age) + 1)? % 16]
    }

    /// The age of an item, if it is one of the last `n`.
    pub fn age(&self, item: T, n: u8) -> Option<u8> {
        (0..n).find(|age| self.get(*age) == Some(item))
    }
}

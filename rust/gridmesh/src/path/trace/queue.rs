//! A monotone bucket queue.

/// Number of buckets: keys this far apart may be queued without a detour.
const WINDOW: u32 = 4096;
const NONE: u32 = u32::MAX;

/// Items with integer keys; keys may never be smaller than the last one taken.
///
/// Buckets are lists in one arena, found by a bit set; the rare keys beyond the window wait aside.
/// Among equal keys the last comes first.
pub(super) struct Queue {
    heads: Vec<u32>,
    filled: Vec<u64>,
    arena: Vec<(u32, u32)>,
    free: u32,
    /// Keys in the buckets are in `now .. now + WINDOW`.
    now: u32,
    in_window: usize,
    aside: Vec<(u32, u32)>,
    least_aside: u32,
}

impl Queue {
    pub fn new() -> Self {
        Self {
            heads: vec![NONE; WINDOW as usize],
            filled: vec![0; WINDOW as usize / 64],
            arena: Vec::new(),
            free: NONE,
            now: 0,
            in_window: 0,
            aside: Vec::new(),
            least_aside: NONE,
        }
    }

    /// Empties the queue; the next keys are at least `now`.
    pub fn clear(&mut self, now: u32) {
        if self.in_window > 0 {
            for (word, heads) in self.filled.iter_mut().zip(self.heads.chunks_exact_mut(64)) {
                while *word != 0 {
                    heads[word.trailing_zeros() as usize] = NONE;
                    *word &= *word - 1;
                }
            }
            self.in_window = 0;
        }
        self.arena.clear();
        self.free = NONE;
        self.aside.clear();
        self.least_aside = NONE;
        self.now = now;
    }

    #[inline]
    pub fn push(&mut self, key: u32, item: u32) {
        debug_assert!(key >= self.now);
        if key - self.now >= WINDOW {
            self.least_aside = self.least_aside.min(key);
            self.aside.push((key, item));
            return;
        }
        let bucket = (key % WINDOW) as usize;
        let entry = (item, self.heads[bucket]);
        let at = if self.free == NONE {
            self.arena.push(entry);
            self.arena.len() as u32 - 1
        } else {
            let at = self.free;
            self.free = self.arena[at as usize].1;
            self.arena[at as usize] = entry;
            at
        };
        self.heads[bucket] = at;
        self.filled[bucket / 64] |= 1 << (bucket % 64);
        self.in_window += 1;
    }

    /// Takes an item of the least key.
    #[inline]
    pub fn pop(&mut self) -> Option<(u32, u32)> {
        loop {
            let key = self.next_key();
            if self.least_aside <= key {
                if self.least_aside == NONE {
                    return None;
                }
                self.take_in();
                continue;
            }
            let bucket = (key % WINDOW) as usize;
            let at = self.heads[bucket];
            let (item, next) = self.arena[at as usize];
            self.arena[at as usize].1 = self.free;
            self.free = at;
            self.heads[bucket] = next;
            if next == NONE {
                self.filled[bucket / 64] &= !(1 << (bucket % 64));
            }
            self.in_window -= 1;
            self.now = key;
            return Some((key, item));
        }
    }

    /// The least key in the buckets.
    #[inline]
    fn next_key(&self) -> u32 {
        if self.in_window == 0 {
            return NONE;
        }
        let start = self.now % WINDOW;
        let words = self.filled.len();
        let first = start as usize / 64;
        let mut word = self.filled[first] & (!0 << (start % 64));
        for step in 0..=words {
            if word != 0 {
                let bucket = ((first + step) % words) as u32 * 64 + word.trailing_zeros();
                return self.now + (bucket + WINDOW - start) % WINDOW;
            }
            word = self.filled[(first + step + 1) % words];
        }
        NONE
    }

    /// Moves the window to the least key and takes in what waits aside and fits.
    fn take_in(&mut self) {
        self.now = self.least_aside;
        self.least_aside = NONE;
        for (key, item) in std::mem::take(&mut self.aside) {
            self.push(key, item);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_come_in_order_far_ones_too() {
        let mut queue = Queue::new();
        let mut state = 7u64;
        for round in 0..3 {
            queue.clear(100 * round);
            let (mut pushed, mut popped, mut last) = (0, 0, 100 * round);
            for step in 0..20_000 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                let random = (state >> 33) as u32;
                if step < 15_000 && random % 5 < 3 {
                    let far = if random.is_multiple_of(31) { 40_000 } else { 3_000 };
                    queue.push(last + (random >> 8) % far, step);
                    pushed += 1;
                } else if let Some((key, _)) = queue.pop() {
                    assert!(key >= last);
                    last = key;
                    popped += 1;
                }
            }
            while let Some((key, _)) = queue.pop() {
                assert!(key >= last);
                last = key;
                popped += 1;
            }
            assert_eq!(pushed, popped);
        }
    }
}

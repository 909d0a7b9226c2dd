//! Disjoint sets.

/// Disjoint sets of the numbers `0..n`; the root of a set is its least member.
pub(crate) struct Disjoint(Vec<u32>);

impl Disjoint {
    /// Every number alone.
    pub fn new(n: usize) -> Self {
        Disjoint((0..n as u32).collect())
    }

    /// The least member of the set that `v` is in. Paths are halved on the way.
    pub fn root(&mut self, v: u32) -> u32 {
        let mut v = v;
        while self.0[v as usize] != v {
            self.0[v as usize] = self.0[self.0[v as usize] as usize];
            v = self.0[v as usize];
        }
        v
    }

    /// Makes one set of those that `a` and `b` are in.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

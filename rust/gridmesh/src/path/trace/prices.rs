//! What it costs, beyond turns and distance, to pass a node in a certain way.

use super::graph::BLOCKED;

/// Prices of one node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extra {
    /// For arriving by each direction.
    pub arrive: [u32; 6],
    /// For having the edge in each direction inside the patch.
    pub inside: [u32; 6],
}

impl Extra {
    /// The sum over the edges inside the patch when the path turns by `turn` and leaves by `out`.
    #[inline]
    pub fn inside(&self, out: u32, turn: i32) -> u32 {
        let count = (2 - turn) as u32;
        (1..=count)
            .map(|k| self.inside[((out + k) % 6) as usize])
            .fold(0, |sum, price| (sum + price).min(BLOCKED))
    }
}

/// Prices of the nodes of one contour; most have none.
#[derive(Clone, Debug)]
pub(super) struct Prices {
    /// Zero, or one more than the index in `extras`.
    index: Vec<u32>,
    extras: Vec<Extra>,
    priced: Vec<u32>,
}

impl Prices {
    pub fn none(n_nodes: usize) -> Self {
        Self { index: vec![0; n_nodes], extras: Vec::new(), priced: Vec::new() }
    }

    #[inline]
    pub fn of(&self, node: u32) -> Option<&Extra> {
        let index = self.index[node as usize];
        (index > 0).then(|| &self.extras[index as usize - 1])
    }

    pub fn of_mut(&mut self, node: u32) -> &mut Extra {
        let index = &mut self.index[node as usize];
        if *index == 0 {
            self.extras.push(Extra::default());
            self.priced.push(node);
            *index = self.extras.len() as u32;
        }
        &mut self.extras[*index as usize - 1]
    }

    /// The nodes that have prices.
    pub fn priced(&self) -> &[u32] {
        &self.priced
    }

    /// Takes all prices back.
    pub fn clear(&mut self) {
        for &node in &self.priced {
            self.index[node as usize] = 0;
        }
        self.extras.clear();
        self.priced.clear();
    }

    /// Charges any visit of a node.
    pub fn raise_visit(&mut self, node: u32, price: u32) {
        for arrive in &mut self.of_mut(node).arrive {
            *arrive = (*arrive + price).min(BLOCKED);
        }
    }

    /// Charges arriving by one direction.
    pub fn raise_arrive(&mut self, node: u32, dir: u32, price: u32) {
        let arrive = &mut self.of_mut(node).arrive[dir as usize];
        *arrive = (*arrive + price).min(BLOCKED);
    }

    /// Charges having the edge in a direction inside the patch.
    pub fn raise_inside(&mut self, node: u32, dir: u32, price: u32) {
        let inside = &mut self.of_mut(node).inside[dir as usize];
        *inside = (*inside + price).min(BLOCKED);
    }
}

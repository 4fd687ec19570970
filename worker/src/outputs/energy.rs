//! Where the energy of a cycle went: powers added up over the integrator's own steps.

use common::outputs::EnergyBalance;

/// Energies and powers of an island at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Instant {
    /// Kinetic energy and that of springs, gravity and contacts [J].
    pub stored: f64,
    /// Power of drives and of loads without potential [W].
    pub input: f64,
    /// Power lost [W].
    pub lost: f64,
    /// Power of elastic contact forces that no potential accounts for [W].
    pub unphysical: f64,
}

/// The account of one island.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Ledger {
    balance: EnergyBalance,
    last: Option<(f64, Instant)>,
}

impl Ledger {
    /// Adds the step from the last instant to this one, at time `t` [s], by the trapezoidal rule.
    pub fn push(&mut self, t: f64, now: Instant) {
        if let Some((before, last)) = self.last {
            let half = 0.5 * (t - before);
            let work = |of: fn(&Instant) -> f64| half * (of(&last) + of(&now));
            let (input, lost, unphysical) = (work(|i| i.input), work(|i| i.lost), work(|i| i.unphysical));
            let stored = now.stored - last.stored;
            self.balance.input += input;
            self.balance.dissipated += lost;
            self.balance.unphysical += unphysical;
            self.balance.stored += stored;
            self.balance.turnover += input.abs() + lost.abs() + unphysical.abs() + stored.abs();
        }
        self.last = Some((t, now));
    }

    /// What came in and where it went.
    pub fn balance(&self) -> EnergyBalance {
        self.balance
    }
}

/// Of several islands together.
pub fn together(balances: impl Iterator<Item = EnergyBalance>) -> EnergyBalance {
    balances.fold(EnergyBalance::default(), |a, b| EnergyBalance {
        input: a.input + b.input,
        stored: a.stored + b.stored,
        dissipated: a.dissipated + b.dissipated,
        unphysical: a.unphysical + b.unphysical,
        turnover: a.turnover + b.turnover,
    })
}

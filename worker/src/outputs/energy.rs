//! Energy balance of a cycle: powers integrated over the time steps by the trapezoidal rule.
//!
//! input + unphysical = change of the stored energy + dissipated [J], up to the error of the integration. Stored are the kinetic
//! energy and the potentials of springs, gravity and contacts; unphysical is the work of elastic contact forces without potential.
//!
//! # Source
//! Power theorem of mechanics: Goldstein, Poole, Safko, Classical Mechanics (2002), chapter 1.

use common::outputs::EnergyBalance;

/// Energies and powers of an island at one instant.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PowerState {
    /// Kinetic energy and that of springs, gravity and contacts [J].
    pub stored: f64,
    /// Power of drives and of loads without potential [W].
    pub input: f64,
    /// Power lost [W].
    pub lost: f64,
    /// Power of elastic contact forces that no potential accounts for [W].
    pub unphysical: f64,
}

/// Energy balance of one island, summed up over its time steps.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EnergyLedger {
    balance: EnergyBalance,
    last: Option<(f64, PowerState)>,
}

impl EnergyLedger {
    /// Adds the step from the last instant to this one, at time `t` [s], by the trapezoidal rule.
    pub(crate) fn push(&mut self, t: f64, now: PowerState) {
        if let Some((before, last)) = self.last {
            let half = 0.5 * (t - before);
            let work = |power: fn(&PowerState) -> f64| half * (power(&last) + power(&now));
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

    /// The balance so far.
    pub(crate) fn balance(&self) -> EnergyBalance {
        self.balance
    }
}

/// Sum of the balances of several islands.
pub(crate) fn sum_of_islands(balances: impl Iterator<Item = EnergyBalance>) -> EnergyBalance {
    balances.fold(EnergyBalance::default(), |a, b| EnergyBalance {
        input: a.input + b.input,
        stored: a.stored + b.stored,
        dissipated: a.dissipated + b.dissipated,
        unphysical: a.unphysical + b.unphysical,
        turnover: a.turnover + b.turnover,
    })
}

//! Caution where the contact law `local-hertz` feeds energy into a mechanism.
//!
//! On a worn bore the elastic force of that law has no potential: over a cycle it does the work W [J] beside the work of drives and loads. Where
//! W is not small against the energy that goes through the mechanism, it maintains a vibration that no real contact would, which changes
//! forces, wear and lives; finer time steps show the same.

use crate::presentation::report::format::three_digits;
use common::outputs::{Diagnostics, EnergyBalance};

/// Share of the energy of a cycle from which on such work is pointed out [1]: the nominal `flapping-wing` has 0.001.
const NOTABLE: f64 = 0.01;

/// The caution about an evaluation that recorded its energy; `None` if there is nothing to point out.
pub fn unphysical_work(diagnostics: &Diagnostics) -> Option<String> {
    let (energy, cycle) = match (&diagnostics.worn_energy, &diagnostics.energy) {
        (Some(worn), _) => (worn, "last"),
        (None, first) => (first.as_ref()?, "first"),
    };
    let share = share(energy)?;
    let (work, through) = (three_digits(energy.unphysical.abs()), three_digits(through(energy)));
    (share > NOTABLE).then(|| {
        format!(
            "in the {cycle} cycle of the nominal mechanism the contact law local-hertz does {work} J of work that no real contact does, {:.0} % of the \
             {through} J that go through it: this law is not conservative on a worn bore, and the vibration that it maintains changes forces, wear \
             and lives, whatever the accuracy; compare with contact_law = \"hertz\"",
            100.0 * share
        )
        .replace('\u{a0}', " ")
    })
}

/// The energy that goes through a mechanism in a cycle [J]: what is put in, or what is lost if that is more.
fn through(energy: &EnergyBalance) -> f64 {
    energy.input.abs().max(energy.dissipated.abs())
}

/// The unphysical work over that energy [1]; `None` without any energy.
fn share(energy: &EnergyBalance) -> Option<f64> {
    let share = energy.unphysical.abs() / through(energy);
    share.is_finite().then_some(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn issue_a_quarter_of_the_energy_came_from_the_contact_law_without_a_word() {
        let energy = |unphysical: f64| EnergyBalance {
            input: 6.478,
            stored: 0.0,
            dissipated: 6.478 + unphysical,
            unphysical,
            turnover: 20.0,
        };
        let said = |first: f64, worn: Option<f64>| {
            unphysical_work(&Diagnostics {
                energy: Some(energy(first)),
                worn_energy: worn.map(energy),
                ..Diagnostics::default()
            })
        };
        let text = said(0.0, Some(1.532)).expect("a caution");
        assert!(
            text.starts_with("in the last cycle")
                && text.contains("1.53 J")
                && text.contains("19 % of the 8.01 J"),
            "{text}"
        );
        assert!(said(0.2, None).is_some_and(|text| text.starts_with("in the first cycle")));
        // An unworn bore does no such work, and that of a worn one may be small.
        assert!(said(0.2, Some(0.01)).is_none() && said(0.0, None).is_none());
        assert!(unphysical_work(&Diagnostics::default()).is_none());
    }
}

//! Linkages from links of PMKS+, whose text after `?` is the mechanism.
//!
//! Parts are separated by points: switches, scale, speeds and units; then joints, links and forces, each list closed by an empty part.
//! Numbers are whole, in base 64 with a leading zero for minus; lengths and angles count thousandths.
//!
//! # Source
//! The encoder of PMKS+ (github.com/PMKS-Web/PMKSWeb, `string-transcoder.ts`): joint `[flags][id],name,x,y,angle[,carrier,end,end]`,
//! link `[Y or N][R or P][id],name,mass,inertia,x,y,colour,joints..,,parts..`.

use super::linkage::{ImportedLinkage, Pin};
use std::collections::BTreeMap;

/// Digits of numbers.
const DIGITS: &str = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-";

/// Flags of a joint.
const SLIDES: u32 = 1;
const IS_INPUT: u32 = 2;
const IS_GROUNDED: u32 = 4;

/// Lengths of the units by their number: inch, centimetre, metre [mm].
const UNITS: [f64; 3] = [25.4, 10.0, 1000.0];

fn number(text: &str) -> Result<f64, String> {
    let (sign, digits) = text.strip_prefix('0').map_or((1.0, text), |rest| (-1.0, rest));
    let size = digits.chars().try_fold(0.0, |sum, digit| Some(64.0 * sum + DIGITS.find(digit)? as f64));
    size.map(|size| sign * size + 0.0).ok_or_else(|| format!("{text:?} is no number of PMKS+"))
}

/// Reads the text after `?` of a link.
///
/// # Errors
/// What is wrong, with the part.
pub(super) fn read(code: &str) -> Result<ImportedLinkage, String> {
    let mut found = ImportedLinkage { links: vec!["frame".to_owned()], ..Default::default() };
    let mut parts = code.trim().split('.');
    let [Some(switches), _, Some(speeds), Some(units)] = std::array::from_fn(|_| parts.next()) else {
        return Err("ends before its joints: copy the whole link".to_owned());
    };
    let mut list = || parts.by_ref().take_while(|part| !part.is_empty()).collect::<Vec<&str>>();
    let [joints, links, forces] = [list(), list(), list()];
    let unit = units.get(..1).map_or(Ok(-1.0), number)?;
    let unit = *UNITS.get(unit as usize).ok_or_else(|| format!("{units:?} are no units of PMKS+"))?;
    let sense = if number(switches)? as u32 & 1 == 1 { -1.0 } else { 1.0 };
    let speed = sense * number(speeds.split(',').next().unwrap_or_default())?;
    let (mut index, mut slides) = (BTreeMap::new(), BTreeMap::new());
    for joint in joints {
        let cells: Vec<&str> = joint.split(',').collect();
        let (Some((flags, id)), [_, _, x, y, angle, guide @ ..]) = (cells[0].split_at_checked(1), &cells[..])
        else {
            return Err(format!("{joint}: expected flags with a name, a name, x, y and angle"));
        };
        let flags = number(flags)? as u32;
        if flags & SLIDES != 0 {
            slides.insert(id, (number(angle)? / 1000.0, guide.to_vec()));
            continue;
        }
        let is_anchor = flags & IS_GROUNDED != 0;
        index.insert(id, found.pins.len());
        found.pins.push(Pin {
            name: id.to_owned(),
            at: [unit * number(x)? / 1000.0, unit * number(y)? / 1000.0],
            is_anchor,
            links: if is_anchor { vec![0] } else { vec![] },
            speed: (flags & IS_INPUT != 0).then_some(speed),
            ..Default::default()
        });
    }
    let mut blocks = Vec::new();
    for link in links {
        let cells: Vec<&str> = link.split(',').collect();
        let of_joints = cells.iter().skip(7).take_while(|cell| !cell.is_empty());
        match link.get(..2) {
            Some("YP") => blocks.push(of_joints.copied().collect::<Vec<&str>>()),
            Some("YR") => {
                for id in of_joints.filter(|id| !slides.contains_key(*id)) {
                    let pin = index.get(id).ok_or_else(|| format!("{link}: there is no joint {id}"))?;
                    found.pins[*pin].links.push(found.links.len());
                }
                found.links.push(cells[0][2..].to_owned());
            }
            // The parts of a welded link, which has all their joints.
            _ => {}
        }
    }
    // A block is a pin on the line of the frame or of a carrier, which comes last.
    for block in blocks {
        let slide = block.iter().find_map(|id| slides.get(id));
        let pin = block.iter().find_map(|id| index.get(id)).copied();
        let (Some((angle, guide)), Some(pin)) = (slide, pin) else {
            return Err(format!("{}: a block has a slide and a pin", block.join(", ")));
        };
        let (axis, carrier) = match guide[..] {
            [carrier, from, to] => {
                let end = |id: &str| index.get(id).map(|pin| found.pins[*pin].at);
                let ends =
                    end(from).zip(end(to)).ok_or_else(|| format!("there is no joint {from} or {to}"))?;
                let ([x, y], [to_x, to_y]) = ends;
                let place = found.links.iter().position(|link| link == carrier);
                ((to_y - y).atan2(to_x - x), place.ok_or_else(|| format!("there is no link {carrier}"))?)
            }
            _ => (*angle, 0),
        };
        let pin = &mut found.pins[pin];
        pin.turns = true;
        // Angles have thousandths of a radian; a tenth of a degree is more.
        pin.slides =
            Some(if carrier == 0 { (10.0 * axis.to_degrees()).round() / 10.0 } else { axis.to_degrees() });
        pin.links.push(carrier);
    }
    found.unread = forces.into_iter().map(|force| format!("force {force}")).collect();
    Ok(found)
}

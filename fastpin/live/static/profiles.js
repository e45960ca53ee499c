// Profiles along the rim of the hole: initial gaps and friction. Angles are in degrees from the bottom.

import { floats } from "live/arrays";

const ROUND = Array.from({ length: 720 }, (_, k) => k / 2 - 180); // angles at which the widest gap is sought

export class Profiles {
  constructor({ profiles, friction }) {
    this.gaps = { hole: profileOf(profiles["gap.hole"]), pin: profileOf(profiles["gap.pin"]) };
    this.coefficient = profileOf(profiles["contact.friction"], friction);
    this.widest = ROUND.reduce((most, angle) => Math.max(most, Math.abs(this.gap("hole", angle) + this.gap("pin", angle))), 0);
  }

  // The initial gap of a body, "hole" or "pin": positive where material is missing.
  gap(body, degrees) {
    return this.gaps[body](degrees);
  }

  // The coefficient of friction under a load.
  friction(degrees, load) {
    return Math.max(this.coefficient(degrees), 0) * (1 + (load.friction_change ?? 0));
  }

  // The largest shear that friction allows in a picture.
  mostShear({ curves: { degrees, pressure }, load }) {
    return degrees.reduce((most, angle, k) => Math.max(most, this.friction(angle, load) * pressure[k] || 0), 0);
  }
}

// A profile from its equally spaced values, the first at -180 degrees; `usual` all round without them.
function profileOf(text, usual = 0) {
  if (text === undefined) return () => usual;
  const values = floats(text), count = values.length;
  return (degrees) => {
    const place = ((degrees + 180) * count) / 360, low = Math.floor(place), share = place - low;
    const at = (k) => values[((k % count) + count) % count];
    return (1 - share) * at(low) + share * at(low + 1);
  };
}

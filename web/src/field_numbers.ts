// How values of a field are written.

/** Whole numbers from here on are written with their power of ten. */
const LARGE = 1e15;

/** A value to a thousandth of a range, as marks of axes have it and what is read off colours. */
export function rounded(value: number, [low, high]: [number, number]): number {
  return high > low ? Number(value.toFixed(Math.min(100, Math.max(0, 2 - Math.floor(Math.log10(high - low)))))) : value;
}

/**
 * What writes a field's values: whole ones in full, others with four digits at least, and with as many more as tell apart what differs by a
 * thousandth of the field's range.
 */
export function writer([low, high]: [number, number]): (value: number) => string {
  const decimals = (size: number) => 3 - Math.floor(Math.log10(size));
  const ofRange = high > low ? decimals(high - low) : 0;
  return (value) => {
    if (!Number.isFinite(value)) return value > 0 ? "∞" : value < 0 ? "−∞" : "none";
    if (value === 0 || (Number.isInteger(value) && Math.abs(value) < LARGE)) return String(value);
    const digits = Math.max(4, ofRange - decimals(Math.abs(value)) + 4);
    return String(Number(value.toPrecision(Math.min(17, digits))));
  };
}

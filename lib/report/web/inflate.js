// SPDX-License-Identifier: GPL-3.0-or-later

// Unpacks zlib streams (RFC 1950 and 1951) within the script. The browser's DecompressionStream ends after the page's load event, so that a program
// that prints a page when it is loaded would print it without maps.

const LENGTHS = [3, 4, 5, 6, 7, 8, 9, 10, 11, 13, 15, 17, 19, 23, 27, 31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258];
const LENGTH_BITS = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 5, 5, 0];
const DISTANCE_BITS = Array.from({length: 30}, (_, k) => Math.max(0, (k >> 1) - 1));
const DISTANCES = DISTANCE_BITS.map((_, k) => k < 4 ? k + 1 : ((2 + (k & 1)) << ((k >> 1) - 1)) + 1);
const CODE_ORDER = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
const END = 256;
const HEADER_BYTES = 2;

/** A table from the next bits of the stream to a symbol and the length of its code: 16 * symbol + length. */
function codeTable(lengths) {
  const bits = Math.max(1, ...lengths), table = new Uint16Array(1 << bits);
  let code = 0;
  for (let length = 1; length <= bits; ++length) {
    lengths.forEach((own, symbol) => {
      if (own !== length) return;
      let first = 0;  // the bits of the code in the order of the stream
      for (let k = 0; k < length; ++k) first |= (code >> k & 1) << (length - 1 - k);
      for (let at = first; at < table.length; at += 1 << length) table[at] = 16 * symbol + length;
      ++code;
    });
    code <<= 1;
  }
  return {table, bits};
}

const FIXED = [Array.from({length: 288}, (_, k) => k < 144 ? 8 : k < 256 ? 9 : k < 280 ? 7 : 8), new Array(30).fill(5)].map(codeTable);

class Stream {
  hold = 0;   // bits that were read ahead, the next one lowest
  held = 0;
  at = HEADER_BYTES;
  length = 0;

  constructor(bytes, size) {
    this.bytes = bytes;
    this.output = new Uint8Array(size);
  }

  fill(count) {
    for (; this.held < count; this.held += 8) this.hold |= this.bytes[this.at++] << this.held;
  }

  drop(count) {
    this.hold >>>= count;
    this.held -= count;
  }

  bits(count) {
    this.fill(count);
    const value = this.hold & (1 << count) - 1;
    this.drop(count);
    return value;
  }

  symbol({table, bits}) {
    this.fill(bits);
    const entry = table[this.hold & table.length - 1];
    this.drop(entry & 15);
    return entry >> 4;
  }

  /** A block that is not compressed begins at the next byte. */
  copyStored() {
    this.at -= this.held >> 3;
    this.hold = this.held = 0;
    const count = this.bytes[this.at] | this.bytes[this.at + 1] << 8;
    this.at += 4;
    this.output.set(this.bytes.subarray(this.at, this.at + count), this.length);
    this.at += count;
    this.length += count;
  }

  readTables() {
    const literals = this.bits(5) + 257, distances = this.bits(5) + 1, codes = this.bits(4) + 4;
    const own = new Array(19).fill(0);
    for (let k = 0; k < codes; ++k) own[CODE_ORDER[k]] = this.bits(3);
    const table = codeTable(own), lengths = [];
    while (lengths.length < literals + distances) {
      const symbol = this.symbol(table);
      if (symbol < 16) {
        lengths.push(symbol);
      } else {
        const repeated = symbol === 16 ? lengths[lengths.length - 1] : 0;
        const count = symbol === 16 ? 3 + this.bits(2) : symbol === 17 ? 3 + this.bits(3) : 11 + this.bits(7);
        for (let k = 0; k < count; ++k) lengths.push(repeated);
      }
    }
    return [lengths.slice(0, literals), lengths.slice(literals)].map(codeTable);
  }

  /** @param {{table: Uint16Array, bits: number}[]} tables of literals with lengths, and of distances */
  expand(tables) {
    const [literals, distances] = tables;
    for (let symbol = this.symbol(literals); symbol !== END; symbol = this.symbol(literals)) {
      if (symbol < END) {
        this.output[this.length++] = symbol;
      } else {
        const count = LENGTHS[symbol - 257] + this.bits(LENGTH_BITS[symbol - 257]), distance = this.symbol(distances);
        this.repeat(count, DISTANCES[distance] + this.bits(DISTANCE_BITS[distance]));
      }
    }
  }

  /** Appends `count` bytes that begin `back` bytes before the end, and that may reach into themselves. */
  repeat(count, back) {
    const {output} = this;
    for (const end = this.length + count; this.length < end; ++this.length) output[this.length] = output[this.length - back];
  }
}

/** The content of a zlib stream, `size` bytes. */
export function inflated(bytes, size) {
  const stream = new Stream(bytes, size);
  for (let isLast = 0; !isLast;) {
    isLast = stream.bits(1);
    const kind = stream.bits(2);
    if (kind === 0) stream.copyStored();
    else stream.expand(kind === 1 ? FIXED : stream.readTables());
  }
  return stream.output;
}

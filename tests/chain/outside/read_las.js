// SPDX-License-Identifier: GPL-3.0-or-later
// usage: node read_las.js FILE: prints what copc reads from a LAS file, as JSON.
import { readFileSync } from "node:fs";
import { Las } from "copc";

const bytes = readFileSync(process.argv[2]);
const header = Las.Header.parse(bytes);
const points = bytes.subarray(header.pointDataOffset,
                              header.pointDataOffset + header.pointCount * header.pointDataRecordLength);
const view = Las.View.create(points, header);
const column = (name) => {
  const get = view.getter(name);
  return Array.from({ length: view.pointCount }, (_, i) => get(i));
};
process.stdout.write(JSON.stringify({
  byReturn: header.pointCountByReturn,
  version: [header.majorVersion, header.minorVersion],
  software: header.generatingSoftware,
  bounds: [header.min, header.max],
  x: column("X"), y: column("Y"), z: column("Z"),
  time: column("GpsTime"), classification: column("Classification"),
  returnNumber: column("ReturnNumber"), returns: column("NumberOfReturns"),
}));

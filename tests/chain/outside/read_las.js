// SPDX-License-Identifier: GPL-3.0-or-later
// usage: node read_las.js FILE: prints what two readers read from a LAS file, as JSON.
import { readFileSync } from "node:fs";
import { parse } from "@loaders.gl/core";
import { LASLoader } from "@loaders.gl/las";
import { Las } from "copc";

const bytes = readFileSync(process.argv[2]);
const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength);

const cloud = await parse(buffer, LASLoader, { worker: false, las: { fp64: true } });
const position = cloud.attributes.POSITION.value;
const loaders = {
  count: cloud.header.vertexCount,
  bounds: cloud.header.boundingBox,
  x: [], y: [], z: [],
  classification: Array.from(cloud.attributes.classification.value),
};
for (let i = 0; i < position.length; i += 3) {
  loaders.x.push(position[i]);
  loaders.y.push(position[i + 1]);
  loaders.z.push(position[i + 2]);
}

const header = Las.Header.parse(bytes);
const points = bytes.subarray(header.pointDataOffset,
                              header.pointDataOffset + header.pointCount * header.pointDataRecordLength);
const view = Las.View.create(points, header);
const column = (name) => {
  const get = view.getter(name);
  return Array.from({ length: view.pointCount }, (_, i) => get(i));
};
const copc = {
  count: view.pointCount,
  byReturn: header.pointCountByReturn,
  version: [header.majorVersion, header.minorVersion],
  software: header.generatingSoftware,
  bounds: [header.min, header.max],
  x: column("X"), y: column("Y"), z: column("Z"),
  time: column("GpsTime"), classification: column("Classification"),
  returnNumber: column("ReturnNumber"), returns: column("NumberOfReturns"),
};
process.stdout.write(JSON.stringify({ loaders, copc }));

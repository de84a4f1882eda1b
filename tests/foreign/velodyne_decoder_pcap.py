"""PyPI velodyne-decoder reads a classic pcap by itself.

usage: velodyne_decoder_pcap.py LIDAR.pcap
Prints the number of measurements, those without a return included.
"""

import json
import sys

import velodyne_decoder as vd

config = vd.Config(model=vd.Model.VLP16, min_range=0.0, max_range=1000.0)
print(json.dumps({"measurements": sum(len(points) for _, points in vd.read_pcap(sys.argv[1], config))}))

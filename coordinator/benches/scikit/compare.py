"""Maximum likelihood fit and prediction by scikit-learn's GaussianProcessRegressor and by Hingewise on the same data.

Prints the table of which coordinator/doc/validation.md states the numbers. Called by run.sh with the path of the program `surrogate_hingewise`.
"""

import json
import os
import platform
import subprocess
import sys
import tempfile
import time
import warnings

import numpy
import sklearn
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

PREDICTIONS = 100_000


def hingewise(program, *arguments):
    run = subprocess.run([program, *arguments], check=True, capture_output=True, text=True)
    return json.loads(run.stdout)


def timed(action):
    wall, processor = time.perf_counter(), time.process_time()
    result = action()
    return result, time.perf_counter() - wall, time.process_time() - processor


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "write", folder], check=True)
        train = numpy.loadtxt(os.path.join(folder, "train.csv"), delimiter=",")
        test = numpy.loadtxt(os.path.join(folder, "test.csv"), delimiter=",")
        (x, y), (x_test, y_test) = ((rows[:, :-1], rows[:, -1]) for rows in (train, test))
        d = x.shape[1]
        # The bounds of Hingewise: theta = 1 / (2 length^2) in 1e-6 .. 10, noise from 1e-10 of the variance on.
        lengths = (0.2236, 707.1)
        kernel = ConstantKernel(1.0, (1e-4, 1e4)) * RBF(numpy.ones(d), lengths) + WhiteKernel(1e-4, (1e-10, 0.3))
        model = GaussianProcessRegressor(kernel, normalize_y=True, n_restarts_optimizer=0, alpha=1e-14)

        ours = hingewise(program, "fit", folder)
        with warnings.catch_warnings():
            # Parameters at their bounds, of variables that hardly matter.
            warnings.simplefilter("ignore")
            _, wall, processor = timed(lambda: model.fit(x, y))
        found = model.kernel_
        variance, noise = found.k1.k1.constant_value, found.k2.noise_level
        with open(os.path.join(folder, "scikit.txt"), "w") as out:
            out.write(f"{noise / variance:.17g}\n")
            out.writelines(f"{0.5 / length**2:.17g}\n" for length in found.k1.k2.length_scale)
        theirs = hingewise(program, "likelihood", folder)
        q2 = 1.0 - numpy.sum((model.predict(x_test) - y_test) ** 2) / numpy.sum((y_test - y_test.mean()) ** 2)

        points = numpy.random.default_rng(1).normal(size=(PREDICTIONS, d))

        def predict():
            for part in numpy.array_split(points, 20):
                model.predict(part, return_std=True)

        _, predict_wall, _ = timed(predict)
        own = hingewise(program, "predict")

    n = len(y)
    print(f"Python {platform.python_version()}, scikit-learn {sklearn.__version__}, NumPy {numpy.__version__}, "
          f"{os.cpu_count()} cores, n = {n}, d = {d}\n")
    print("| fit | scikit-learn | Hingewise |")
    print("| --- | --- | --- |")
    print(f"| time, Hingewise = 1 | {wall / ours['wall_s']:.1f} | 1 |")
    print(f"| processor time, Hingewise = 1 | {processor / ours['processor_s']:.1f} | 1 |")
    print(f"| logarithm of the likelihood above scikit-learn's | 0 | {0.5 * n * (theirs - ours['value']):.2f} |")
    print(f"| Q2 on {len(y_test)} other points | {q2:.5f} | {ours['q2']:.5f} |")
    print()
    print(f"| {PREDICTIONS} means and variances, the bare triangular solve = 1 | |")
    print("| --- | --- |")
    print(f"| scikit-learn | {predict_wall / own['solve_s']:.2f} |")
    print(f"| Hingewise | {own['predict_s'] / own['solve_s']:.2f} |")
    print(f"| Hingewise, one point added at the same lengths | {own['added_s'] / own['solve_s']:.3f} |")
    seconds = {"scikit-learn fit": wall, "Hingewise fit": ours["wall_s"], "solve": own["solve_s"],
               "predictions": own["predict_s"], "one point added": own["added_s"]}
    print("\nSeconds: " + ", ".join(f"{name} {value:.3g}" for name, value in seconds.items())
          + f"; {ours['evaluations']} evaluations of the likelihood", file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1])

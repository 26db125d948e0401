"""The script of `kairos jobs slurm`, submitted to a Slurm of its own: two nodes on this machine, one of which is killed.

Usage: slurm.py PROJECT_ROOT KAIROS

Starts munged, slurmctld and two slurmd with configurations, keys and ports of their own in a new folder, and stops them by
their process ids. Exit status 77 where Slurm is not installed, or may not be started: it has to be root.
"""

import os
import pathlib
import secrets
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time

root, kairos = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
SKIPPED = 77
PARTS = 6


def program(name):
    found = shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin")
    if not found:
        print(f"{name} is not installed: skipped")
        sys.exit(SKIPPED)
    return found


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for one in sockets:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


class Cluster:
    def __init__(self, folder):
        self.folder, self.running = folder, {}
        controller, first, second = free_ports(3)
        key = folder / "munge.key"
        key.write_bytes(secrets.token_bytes(128))
        key.chmod(0o400)
        for name in ("state", "spool1", "spool2"):
            (folder / name).mkdir()
        host = socket.gethostname().split(".")[0]
        node = f"NodeHostname={host} NodeAddr=127.0.0.1 CPUs=1 RealMemory=500 State=UNKNOWN"
        (folder / "slurm.conf").write_text(f"""ClusterName=kairos_test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdTimeout=6
MinJobAge=300
ReturnToService=2
SchedulerParameters=requeue_delay=1
NodeName=n1 {node} Port={first}
NodeName=n2 {node} Port={second}
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
""")
        self.environment = dict(os.environ, SLURM_CONF=str(folder / "slurm.conf"), PATH=f"{kairos.parent}:{os.environ['PATH']}:/usr/sbin")
        folder.chmod(0o755)
        self.start("munged", ["munged", "--foreground", f"--key-file={key}", f"--socket={folder}/munge.socket", f"--pid-file={folder}/munge.pid",
                              f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed", "--force"])
        self.wait("munged does not start", lambda: (folder / "munge.socket").exists())
        self.start("slurmctld", ["slurmctld", "-D", "-i"])
        for name in ("n1", "n2"):
            self.start(name, ["slurmd", "-D", "-N", name])
        self.wait("the nodes do not come up", lambda: self.run(["sinfo", "-h", "-t", "idle", "-o", "%D"]).strip() == "2")

    def start(self, name, command):
        log = open(self.folder / f"{name}.out", "w")
        self.running[name] = subprocess.Popen([program(command[0]), *command[1:]], env=self.environment, stdout=log,
                                              stderr=subprocess.STDOUT)

    def run(self, command, **options):
        done = subprocess.run([program(command[0]), *command[1:]], env=self.environment, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=60, **options)
        return done.stdout

    def wait(self, problem, holds, seconds=60):
        end = time.time() + seconds
        while not holds():
            if time.time() > end:
                for log in sorted(self.folder.glob("*.out")):
                    print(f"-- {log.name}\n{log.read_text()[-2000:]}")
                print(problem)
                sys.exit(1)
            time.sleep(0.2)

    def stop(self):
        for process in reversed(self.running.values()):
            process.kill()
            process.wait()


def main():
    for name in ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo"):
        program(name)
    if os.geteuid() != 0:
        print("needs root: skipped")
        sys.exit(SKIPPED)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="kairos_slurm_", dir="/tmp"))
    work = folder / "work"
    work.mkdir()
    cluster = None
    try:
        cluster = Cluster(folder)
        options = [str(root / "scenes/star/star.json"), "--size", "160x90", "--tc-rays", "16", "--threads", "1", "--quiet"]
        subprocess.run([kairos, "render", *options, "-o", work / "whole.exr"], check=True)
        script = subprocess.run([kairos, "jobs", "slurm", *options, "-o", "parts.exr", "--parts", str(PARTS)], check=True, cwd=work,
                                text=True, stdout=subprocess.PIPE).stdout
        (work / "submit.sh").write_text(script)
        print(cluster.run(["sh", "submit.sh"], cwd=work))
        # One node dies while the parts are on their way: the other one does its work again.
        cluster.wait("no part appears", lambda: list(work.glob("parts.exr.parts/*.exr")))
        cluster.running["n2"].send_signal(signal.SIGKILL)
        cluster.wait("the merged picture does not appear:\n" + cluster.run(["squeue"]), lambda: (work / "parts.exr").exists(), 240)
        compared = subprocess.run([kairos, "compare", work / "whole.exr", work / "parts.exr"], text=True, stdout=subprocess.PIPE)
        print(compared.stdout)
        if compared.returncode != 0 or "MSE 0," not in compared.stdout:
            sys.exit("the merged picture is another one")
    finally:
        if cluster is not None:
            cluster.stop()
        shutil.rmtree(folder, ignore_errors=True)


main()

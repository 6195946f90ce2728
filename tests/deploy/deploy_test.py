"""What is deployed agrees with itself, with the programs and with the tools that read it.

    TETSTREAM_BIN=build/dev/bin python3 tests/deploy/deploy_test.py [unittest options]
"""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
LAME_DUCK_SECONDS = 5
DRAIN_SECONDS = 30
GRACE_SECONDS = 10  # which the server gives itself


def tetstreamd():
    return pathlib.Path(os.environ["TETSTREAM_BIN"]).resolve() / "tetstreamd"


def run(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=900,
                          check=False, **options)


class DeployTest(unittest.TestCase):
    def assert_taken(self, environment):
        """The server takes all of these TETSTREAM_ variables as settings."""
        settings = {name: str(value) for name, value in environment.items()
                    if name.startswith("TETSTREAM_")}
        printed = run(tetstreamd(), "--print-config", env=settings)
        self.assertEqual(printed.returncode, 0, printed.stderr)
        known = set(re.findall(r"^(\w+) = ", printed.stdout, re.MULTILINE))
        self.assertEqual({name for name in settings
                          if name.removeprefix("TETSTREAM_").lower() not in known}, set())

    def assert_longer_than_a_drain(self, seconds):
        printed = run(tetstreamd(), "--print-config").stdout
        self.assertIn(f"\nlame_duck_seconds = {LAME_DUCK_SECONDS}\n", printed)
        self.assertIn(f"\ndrain_seconds = {DRAIN_SECONDS}\n", printed)
        self.assertIn(f"\ngrace_seconds = {GRACE_SECONDS}\n", printed)
        self.assertGreater(seconds, LAME_DUCK_SECONDS + DRAIN_SECONDS + GRACE_SECONDS)


class Systemd(DeployTest):
    units = ROOT / "deploy" / "systemd"

    def test_systemd_takes_the_units_and_they_expose_little(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        for unit in self.units.glob("*.service"):
            here = pathlib.Path(scratch.name) / unit.name
            here.write_text(unit.read_text().replace("/usr/local/bin/tetstreamd", str(tetstreamd())))
            verified = run("systemd-analyze", "verify", "--man=no", here)
            self.assertEqual((verified.returncode, verified.stdout, verified.stderr), (0, "", ""))
            exposed = run("systemd-analyze", "security", "--offline=yes", "--threshold=20", here)
            self.assertEqual(exposed.returncode, 0, exposed.stdout)

    def test_a_drain_ends_before_the_server_is_killed(self):
        seconds = re.search(r"^TimeoutStopSec=(\d+)$", (self.units / "tetstreamd.service").read_text(),
                            re.MULTILINE)
        self.assert_longer_than_a_drain(int(seconds[1]))

    def test_the_server_takes_the_settings_as_they_are_and_as_they_propose(self):
        for settings in self.units.glob("*.toml"):
            proposed = re.sub(r"^#(\w+ = )", r"\1", settings.read_text(), flags=re.MULTILINE)
            self.assertNotEqual(proposed, settings.read_text())
            with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
                file.write(proposed)
                file.flush()
                for path in (settings, file.name):
                    printed = run(tetstreamd(), "--config", path, "--print-config")
                    self.assertEqual((printed.returncode, printed.stderr), (0, ""), settings.name)

    def test_nothing_starts_on_the_folder_that_a_store_is_mounted_on(self):
        for unit in self.units.glob("*.service"):
            store = re.search(r"^Environment=TETSTREAM_STORE=(\S+)$", unit.read_text(), re.MULTILINE)
            self.assertIn(f"\nRequiresMountsFor={store[1]}\n", unit.read_text())

    def test_a_start_that_fails_for_a_minute_is_tried_again(self):
        for unit in self.units.glob("*.service"):
            head, service = unit.read_text().split("[Service]")
            self.assertIn("\nStartLimitIntervalSec=0\n", head, unit.name)
            self.assertRegex(service, r"\nRestart=on-failure\nRestartSec=\d+\n", unit.name)

    def test_the_user_is_the_containers(self):
        number = re.search(r"useradd --uid (\d+)",
                           (ROOT / "docker" / "server.Dockerfile").read_text())[1]
        self.assertIn(f"\nu tetstream {number} ",
                      (self.units / "tetstream.sysusers").read_text())


class Kubernetes(DeployTest):
    @classmethod
    def setUpClass(cls):
        text = (ROOT / "deploy" / "kubernetes" / "tetstream.yaml").read_text()
        cls.objects = {(thing["kind"], thing["metadata"]["name"]): thing
                       for thing in yaml.safe_load_all(text)}
        cls.deployments = {name: thing["spec"] for (kind, name), thing in cls.objects.items()
                           if kind == "Deployment"}
        cls.head = text[:text.index("\napiVersion")]

    def pods(self):
        for deployment in self.deployments.values():
            yield deployment["template"]["spec"], deployment["template"]["spec"]["containers"][0]

    def test_the_objects_are_these(self):
        self.assertEqual(
            {(thing["apiVersion"], kind, name) for (kind, name), thing in self.objects.items()},
            {("v1", "ConfigMap", "tetstream"), ("v1", "PersistentVolumeClaim", "tetstream"),
             ("v1", "Service", "tetstream"), ("apps/v1", "Deployment", "tetstream-server"),
             ("apps/v1", "Deployment", "tetstream-worker"),
             ("policy/v1", "PodDisruptionBudget", "tetstream-server"),
             ("networking.k8s.io/v1", "NetworkPolicy", "tetstream-server"),
             ("networking.k8s.io/v1", "NetworkPolicy", "tetstream-worker"),
             ("keda.sh/v1alpha1", "ScaledObject", "tetstream-worker")})

    def test_each_selects_its_own_pods(self):
        labels = {name: deployment["template"]["metadata"]["labels"]
                  for name, deployment in self.deployments.items()}
        for name, deployment in self.deployments.items():
            self.assertEqual(deployment["selector"]["matchLabels"], labels[name])
        served = self.objects["Service", "tetstream"]["spec"]["selector"].items()
        self.assertEqual([name for name in labels if served <= labels[name].items()],
                         ["tetstream-server"])

    def test_what_pods_refer_to_is_there(self):
        for pod, container in self.pods():
            for source in container["envFrom"]:
                self.assertIn(("ConfigMap", source["configMapRef"]["name"]), self.objects)
            secrets = [value["valueFrom"]["secretKeyRef"] for value in container["env"]
                       if "valueFrom" in value]
            for secret in secrets:
                self.assertIn(f"secret generic {secret['name']} ", self.head)
                self.assertIn(f"--from-literal={secret['key']}=", self.head)
            self.assertEqual({mount["name"] for mount in container["volumeMounts"]},
                             {volume["name"] for volume in pod["volumes"]})
            for volume in pod["volumes"]:
                if "secret" in volume:
                    self.assertRegex(self.head, rf"secret \w+ {volume['secret']['secretName']} ")
            claims = [volume["persistentVolumeClaim"]["claimName"] for volume in pod["volumes"]
                      if "persistentVolumeClaim" in volume]
            for claim in claims:
                self.assertIn(("PersistentVolumeClaim", claim), self.objects)
            ports = {port["name"]: port["containerPort"] for port in container["ports"]}
            for probe in (container.get("readinessProbe", {}), container["livenessProbe"]):
                if "httpGet" in probe:
                    self.assertIn(probe["httpGet"]["port"], ports)
                if "grpc" in probe:
                    self.assertIn(probe["grpc"]["port"], ports.values())
                    self.assertIn(probe["grpc"]["service"], ("readiness", "liveness"))

    def test_they_share_one_store_and_servers_go_one_after_the_other(self):
        stores = {(volume["persistentVolumeClaim"]["claimName"], mount["mountPath"])
                  for pod, container in self.pods() for volume in pod["volumes"]
                  for mount in container["volumeMounts"]
                  if "persistentVolumeClaim" in volume and mount["name"] == volume["name"]}
        settings = self.objects["ConfigMap", "tetstream"]["data"]
        self.assertEqual(stores, {("tetstream", settings["TETSTREAM_STORE"])})
        claim = self.objects["PersistentVolumeClaim", "tetstream"]["spec"]
        self.assertEqual(claim["accessModes"], ["ReadWriteMany"])
        server = self.deployments["tetstream-server"]
        self.assertGreater(server["replicas"], 1)
        self.assertEqual(server["strategy"]["rollingUpdate"]["maxUnavailable"], 0)
        budget = self.objects["PodDisruptionBudget", "tetstream-server"]["spec"]
        self.assertLess(budget["minAvailable"], server["replicas"])
        self.assertEqual(budget["selector"], server["selector"])

    def test_the_settings_are_the_servers(self):
        for _, container in self.pods():
            self.assert_taken({
                **self.objects["ConfigMap", "tetstream"]["data"],
                **{value["name"]: value.get("value", "postgresql://") for value in container["env"]}})

    def test_pods_may_do_little(self):
        for pod, container in self.pods():
            self.assertTrue(pod["securityContext"]["runAsNonRoot"])
            self.assertEqual(pod["securityContext"]["seccompProfile"]["type"], "RuntimeDefault")
            self.assertFalse(pod["automountServiceAccountToken"])
            self.assertTrue(container["securityContext"]["readOnlyRootFilesystem"])
            self.assertFalse(container["securityContext"]["allowPrivilegeEscalation"])
            self.assertEqual(container["securityContext"]["capabilities"], {"drop": ["ALL"]})
            self.assertIn("memory", container["resources"]["limits"])

    def test_a_drain_ends_before_the_server_is_killed(self):
        pod = self.deployments["tetstream-server"]["template"]["spec"]
        self.assert_longer_than_a_drain(pod["terminationGracePeriodSeconds"])

    def test_a_server_asks_for_tokens_over_tls_of_files_that_its_group_may_read(self):
        pod = self.deployments["tetstream-server"]["template"]["spec"]
        container = pod["containers"][0]
        mounted = {mount["mountPath"]: mount["name"] for mount in container["volumeMounts"]}
        secrets = {volume["name"]: volume["secret"] for volume in pod["volumes"] if "secret" in volume}
        settings = {value["name"]: value.get("value", "") for value in container["env"]}
        for name, file in (("TLS_CERT", "tls.crt"), ("TLS_KEY", "tls.key"), ("TOKENS", "tokens.toml")):
            path = pathlib.Path(settings["TETSTREAM_" + name])
            self.assertEqual(path.name, file)
            self.assertEqual(secrets[mounted[str(path.parent)]]["defaultMode"], 0o440)
        self.assertIn("fsGroup", pod["securityContext"])
        self.assertIn("--from-file=tokens.toml", self.head)

    def test_pods_are_reached_by_clients_and_prometheus_alone(self):
        for name, deployment in self.deployments.items():
            policy = self.objects["NetworkPolicy", name]["spec"]
            self.assertEqual(policy["podSelector"], deployment["selector"])
            self.assertEqual(policy["policyTypes"], ["Ingress"])
            ports = {port["name"] for port in deployment["template"]["spec"]["containers"][0]["ports"]}
            self.assertEqual({port["port"] for rule in policy["ingress"] for port in rule["ports"]},
                             ports)
            self.assertTrue(all(rule["from"] for rule in policy["ingress"]))

    def test_workers_are_as_many_as_pending_shards_ask_for(self):
        scaled = self.objects["ScaledObject", "tetstream-worker"]["spec"]
        self.assertIn(scaled["scaleTargetRef"]["name"], self.deployments)
        self.assertNotIn("replicas", self.deployments["tetstream-worker"])
        trigger = scaled["triggers"][0]
        self.assertEqual(trigger["type"], "prometheus")
        self.assertLessEqual({"serverAddress", "query", "threshold"}, trigger["metadata"].keys())
        self.assertTrue(all(isinstance(value, str) for value in trigger["metadata"].values()))
        self.assertTrue(trigger["metadata"]["threshold"].isdigit())
        self.assert_counts_pending_shards(trigger["metadata"]["query"])

    def assert_counts_pending_shards(self, query):
        """For Prometheus, over what two processes tell of one queue of 3 + 2 + 1 shards."""
        series = [f'tetstream_job_shards{{state="{state}",namespace="tetstream",pod="{pod}"}}'
                  for state in ("ready", "leased", "backing_off", "dead") for pod in "ab"]
        values = [3, 3, 2, 2, 1, 1, 9, 9]
        with tempfile.TemporaryDirectory() as scratch:
            test = pathlib.Path(scratch) / "test.yml"
            test.write_text(yaml.safe_dump({"tests": [{
                "interval": "1m",
                "input_series": [{"series": name, "values": str(value)}
                                 for name, value in zip(series, values)],
                "promql_expr_test": [{"expr": query, "eval_time": "0m",
                                      "exp_samples": [{"labels": "{}", "value": 6}]}]}]}))
            tested = run("promtool", "test", "rules", test)
        self.assertEqual(tested.returncode, 0, tested.stdout + tested.stderr)


class Compose(DeployTest):
    def services(self, *files):
        arguments = [argument for file in files for argument in ("-f", ROOT / "docker" / file)]
        taken = run("docker-compose", *arguments, "config")
        self.assertEqual(taken.returncode, 0, taken.stderr)
        return yaml.safe_load(taken.stdout)["services"]

    def test_compose_takes_its_files_and_the_server_their_settings(self):
        for files in (["compose.yml"], ["compose.yml", "compose.farm.yml"]):
            for name, service in self.services(*files).items():
                if service["image"] == "tetstream":
                    self.assert_taken(service.get("environment", {}))
                    grace = service["stop_grace_period"]
                    if name == "tetstream":
                        self.assert_longer_than_a_drain(int(grace.removesuffix("s")))

    def test_a_farm_shares_store_jobs_and_budget(self):
        services = self.services("compose.yml", "compose.farm.yml")
        server, worker = services["tetstream"], services["worker"]
        for name in ("TETSTREAM_JOBS", "TETSTREAM_RESULT_BYTES"):
            self.assertEqual(server["environment"][name], worker["environment"][name])
        self.assertEqual(server["volumes"], worker["volumes"])
        self.assertIn("@jobs/", server["environment"]["TETSTREAM_JOBS"])
        self.assertIn("jobs", services)
        self.assertEqual(str(server["environment"]["TETSTREAM_JOB_WORKERS"]), "0")

    def test_a_farms_second_server_is_as_the_first_and_behind_the_same_proxy(self):
        services = self.services("compose.yml", "compose.farm.yml")
        first, second, proxy = services["tetstream"], services["second"], services["proxy"]
        for name in first.keys() - {"build", "ports"}:
            self.assertEqual(first[name], second[name], name)
        self.assertEqual(second.keys() - first.keys(), {"profiles"})
        self.assertEqual(second["profiles"], proxy["profiles"])
        self.assertEqual(set(proxy["depends_on"]), {"tetstream", "second"})
        for name, of in (("SERVER", "tetstream"), ("SECOND", "second")):
            health = "" if name == "SERVER" else name + "_"
            told = {key: proxy["environment"][f"TETSTREAM_PROXY_{key}"]
                    for key in (name, health + "HEALTH_HOST", health + "HEALTH_PORT")}
            self.assertEqual(list(told.values()), [f"{of}:7447", of, "9464"])



class Alerts(unittest.TestCase):
    rules = ROOT / "docker" / "alerts.yml"
    manual = (ROOT / "docs" / "operations.md").read_text()

    def test_each_fires_when_it_should_and_not_before(self):
        tested = run("promtool", "test", "rules", ROOT / "tests" / "deploy" / "alerts_promtool.yml")
        self.assertEqual(tested.returncode, 0, tested.stdout + tested.stderr)
        shown = (ROOT / "tests" / "deploy" / "alerts_promtool.yml").read_text()
        for name in re.findall(r"alert: (\w+)", self.rules.read_text()):
            self.assertGreaterEqual(shown.count(f"alertname: {name}"), 2, name)

    def test_they_ask_for_metrics_that_there_are(self):
        asked = set(re.findall(r"tetstream_\w+", self.rules.read_text()))
        self.assertGreater(len(asked), 8)
        self.assertEqual({name for name in asked if f"`{name}`" not in self.manual}, set())


if __name__ == "__main__":
    unittest.main(verbosity=2)

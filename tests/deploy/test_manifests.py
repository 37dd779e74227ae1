"""The manifests for Kubernetes: they satisfy the schemas, and have the promised settings for security."""

from __future__ import annotations

import copy
import json
import os
import subprocess
from pathlib import Path
from typing import Any, Callable, Dict, List

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "deploy" / "kubernetes"


def manifests() -> List[Dict[str, Any]]:
    """The manifests that the kustomization lists."""
    return [document for name in kustomization(FOLDER)["resources"] for document in yaml.safe_load_all((FOLDER / name).read_text())]


def kustomization(folder: Path) -> Dict[str, Any]:
    return yaml.safe_load((folder / "kustomization.yaml").read_text())  # type: ignore[no-any-return]


def merged(value: Any, patch: Any) -> Any:
    """Applies a strategic merge patch, as far as these files need it: lists of named objects are merged by names, others replaced."""
    if isinstance(value, dict) and isinstance(patch, dict):
        return {key: merged(value[key], patch[key]) if key in value and key in patch else patch.get(key, value.get(key))
                for key in {**value, **patch}}
    named = [isinstance(item, dict) and "name" in item for item in patch] if isinstance(patch, list) else []
    if isinstance(value, list) and named and all(named):
        changes = {item["name"]: item for item in patch}
        kept = [merged(item, changes.pop(item["name"])) if item["name"] in changes else item for item in value]
        return kept + list(changes.values())
    return patch


def shared_manifests() -> List[Dict[str, Any]]:
    """The manifests for several servers."""
    patches = [yaml.safe_load((FOLDER / "shared" / patch["path"]).read_text()) for patch in kustomization(FOLDER / "shared")["patches"]]
    documents = manifests()
    for patch in patches:
        [place] = [i for i, document in enumerate(documents)
                   if (document["kind"], document["metadata"]["name"]) == (patch["kind"], patch["metadata"]["name"])]
        documents[place] = merged(documents[place], patch)
    return documents


def of_kind(kind: str) -> Dict[str, Any]:
    found = [document for document in manifests() if document["kind"] == kind]
    assert len(found) == 1, f"{len(found)} objects of the kind {kind}"
    return found[0]


def faults_of(objects: List[Dict[str, Any]]) -> str:
    done = subprocess.run(["node", "check_manifests.mjs"], cwd=Path(__file__).parent, input=json.dumps(objects), text=True,
                          capture_output=True, timeout=300, check=False)
    assert done.returncode == (1 if done.stdout else 0), done.stderr
    return done.stdout


def test_the_manifests_are_as_the_schemas_say() -> None:
    kinds = [document["kind"] for document in manifests()]
    assert sorted(kinds) == ["ConfigMap", "Deployment", "NetworkPolicy", "PersistentVolumeClaim", "PodDisruptionBudget", "Service"]
    assert faults_of(manifests()) == ""


def test_every_file_is_in_a_kustomization() -> None:
    for folder in (FOLDER, FOLDER / "shared"):
        listed = kustomization(folder)
        names = {name for name in listed["resources"] if name != ".."} | {patch["path"] for patch in listed.get("patches", [])}
        assert names == {path.name for path in folder.glob("*.yaml")} - {"kustomization.yaml"}


def test_several_servers_share_a_database_and_a_volume_and_are_replaced_one_after_the_other() -> None:
    documents = shared_manifests()
    assert faults_of(documents) == ""
    by_kind = {document["kind"]: document for document in documents}
    spec = by_kind["Deployment"]["spec"]
    assert spec["replicas"] == 3 and spec["strategy"]["type"] == "RollingUpdate"
    assert spec["strategy"]["rollingUpdate"]["maxUnavailable"] == 0
    pod = spec["template"]["spec"]
    [container] = pod["containers"]
    variables = {entry["name"]: entry for entry in container["env"]}
    assert set(variables) >= {"SUPPLE_CONFIG", "SUPPLE_DATA", "SUPPLE_KEYS", "SUPPLE_DATABASE", "SUPPLE_DRAIN"}
    probe = container["readinessProbe"]
    drain = float(variables["SUPPLE_DRAIN"]["value"])
    assert drain > probe["periodSeconds"] * probe["failureThreshold"], "the service has noticed before the server refuses"
    grace = 30
    assert pod["terminationGracePeriodSeconds"] > drain + grace
    assert by_kind["PersistentVolumeClaim"]["spec"]["accessModes"] == ["ReadWriteMany"]
    assert by_kind["Service"]["spec"]["sessionAffinity"] == "ClientIP"
    [database, names] = by_kind["NetworkPolicy"]["spec"]["egress"]
    assert database["ports"] == [{"protocol": "TCP", "port": 5432}] and names["ports"][0]["port"] == 53


def test_what_the_schemas_do_not_know_is_found() -> None:
    def broken(change: Callable[[Dict[str, Any]], None]) -> Dict[str, Any]:
        document = copy.deepcopy(of_kind("Deployment"))
        change(document)
        return document

    faults = faults_of([
        broken(lambda document: document["spec"].update(replicas="one")),
        broken(lambda document: document["spec"]["template"]["spec"]["containers"][0].update(livenesProbe={})),
        {"apiVersion": "apps/v2", "kind": "Deployment", "metadata": {"name": "later"}},
        {"apiVersion": "apps/v1", "kind": "Deployement", "metadata": {"name": "misspelt"}},
    ])
    for part in ("replicas must be integer", "livenesProbe", "no apiVersion 'apps/v2'", "no kind 'Deployement'"):
        assert part in faults, faults


def test_the_pod_is_not_root_and_writes_to_its_volumes_alone() -> None:
    pod = of_kind("Deployment")["spec"]["template"]["spec"]
    assert pod["securityContext"]["runAsNonRoot"] is True and pod["securityContext"]["runAsUser"] == 10001
    assert pod["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
    assert pod["automountServiceAccountToken"] is False
    [container] = pod["containers"]
    assert container["securityContext"] == {"allowPrivilegeEscalation": False, "readOnlyRootFilesystem": True,
                                            "capabilities": {"drop": ["ALL"]}}
    writable = {mount["mountPath"] for mount in container["volumeMounts"] if not mount.get("readOnly")}
    assert writable == {"/var/lib/supple", "/tmp"}


def test_two_servers_never_share_the_volume() -> None:
    spec = of_kind("Deployment")["spec"]
    assert spec["replicas"] == 1 and spec["strategy"] == {"type": "Recreate"}
    assert of_kind("PersistentVolumeClaim")["spec"]["accessModes"] == ["ReadWriteOnce"]


def test_the_pod_has_probes_and_limits() -> None:
    [container] = of_kind("Deployment")["spec"]["template"]["spec"]["containers"]
    assert container["livenessProbe"]["httpGet"]["path"] == "/healthz"
    assert container["readinessProbe"]["httpGet"]["path"] == container["startupProbe"]["httpGet"]["path"] == "/readyz"
    for amount in ("requests", "limits"):
        assert set(container["resources"][amount]) >= {"cpu", "memory"}
    # Otherwise Kubernetes would set the variable SUPPLE_PORT for the service.
    assert of_kind("Deployment")["spec"]["template"]["spec"]["enableServiceLinks"] is False


def test_names_and_labels_fit_together() -> None:
    deployment = of_kind("Deployment")
    pod = deployment["spec"]["template"]
    labels = pod["metadata"]["labels"]
    for selector in (deployment["spec"]["selector"]["matchLabels"], of_kind("Service")["spec"]["selector"],
                     of_kind("PodDisruptionBudget")["spec"]["selector"]["matchLabels"],
                     of_kind("NetworkPolicy")["spec"]["podSelector"]["matchLabels"]):
        assert selector.items() <= labels.items()
    volumes = {volume["name"]: volume for volume in pod["spec"]["volumes"]}
    assert volumes["data"]["persistentVolumeClaim"]["claimName"] == of_kind("PersistentVolumeClaim")["metadata"]["name"]
    assert volumes["configuration"]["configMap"]["name"] == of_kind("ConfigMap")["metadata"]["name"]
    [container] = pod["spec"]["containers"]
    assert {mount["name"] for mount in container["volumeMounts"]} == set(volumes)
    [port] = container["ports"]
    assert of_kind("Service")["spec"]["ports"][0]["targetPort"] == port["name"]
    assert of_kind("NetworkPolicy")["spec"]["ingress"][0]["ports"][0]["port"] == port["containerPort"]


def test_the_server_would_start_with_the_variables_and_the_file(tmp_path: Path) -> None:
    build = Path(os.environ.get("SUPPLE_BUILD", ROOT / "build" / "release"))
    server = build / "server" / "supple-server"
    if not server.exists():
        pytest.skip(f"{server} is not built")
    configuration = tmp_path / "supple.toml"
    configuration.write_text(of_kind("ConfigMap")["data"]["supple.toml"])
    variables = {entry["name"]: entry["value"] for entry in of_kind("Deployment")["spec"]["template"]["spec"]["containers"][0]["env"]}
    assert variables["SUPPLE_CONFIG"] == "/etc/supple/supple.toml"
    variables.update(SUPPLE_CONFIG=str(configuration), SUPPLE_DATA=str(tmp_path / "data"), SUPPLE_KEYS=str(tmp_path / "keys"),
                     SUPPLE_HOST="0.0.0.0")
    subprocess.run([str(server), "keys", "add", "--name", "team", "--scopes", "read"], env=variables, check=True, timeout=60,
                   capture_output=True)
    done = subprocess.run([str(server), "--check-config"], env=variables, capture_output=True, text=True, timeout=60, check=False)
    assert (done.returncode, done.stderr) == (0, ""), done.stderr

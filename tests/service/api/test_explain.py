"""Explanations over HTTP: a job whose result is that of the command line."""

from service.api.schemas import ExplainResult


def test_an_explanation_is_a_job_whose_result_then_answers_the_question(server):
    link = "/v1/explain?model=lambert&techniques=cosine&theta_o_deg=0,60&statistics=mean"
    reply = server.client.get(link)
    assert reply.status_code == 202
    job = server.await_job(reply.headers["location"])
    assert (job["kind"], job["state"]) == ("explain", "done")
    scene = {"model": "lambert", "techniques": ["cosine"], "theta_o_deg": [0, 60], "statistics": ["mean"]}
    answer = server.client.post("/v1/explain", json=scene)
    assert answer.status_code == 200
    result = answer.json()
    ExplainResult.model_validate(result)
    statistics = server.ask(scene | {"estimator": {"samples": 100}, "reference": False}).json()
    assert [{k: v for k, v in one.items() if k != "saves"} for one in result["left_out"]] == statistics["left_out"]
    assert "largest weight" in server.client.get(link, headers={"accept": "text/plain"}).text


def test_a_scene_that_cannot_be_explained_is_a_problem_that_names_the_field(server):
    reply = server.client.get("/v1/explain?model=lambert&method=quadrature")
    assert reply.status_code == 422
    assert reply.json()["errors"][0]["field"] == "estimator.method"

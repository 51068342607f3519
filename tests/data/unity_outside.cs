// What docs/scripts/TritrackBodies.cs uses of Unity, and a program that runs it outside.
namespace UnityEngine {
  public class MonoBehaviour { public Transform transform = new Transform(); }
  public struct Vector3 { public float x, y, z; public Vector3(float a, float b, float c) { x = a; y = b; z = c; } }
  public class Transform { public Transform parent; public Vector3 localScale, localPosition; }
  public enum PrimitiveType { Sphere }
  public class GameObject { public Transform transform = new Transform();
    public static System.Collections.Generic.List<GameObject> all = new System.Collections.Generic.List<GameObject>();
    public static GameObject CreatePrimitive(PrimitiveType of) { var made = new GameObject(); all.Add(made); return made; } }
}
public static class Program {
  public static void Main(string[] given) {
    var unity = new TritrackBodies { address = given[0] };
    const System.Reflection.BindingFlags ours = System.Reflection.BindingFlags.NonPublic | System.Reflection.BindingFlags.Instance;
    System.Action<string> call = name => typeof(TritrackBodies).GetMethod(name, ours).Invoke(unity, null);
    call("OnEnable");
    for (int tries = 0; tries < 600 && unity.doing == ""; tries++) { System.Threading.Thread.Sleep(50); call("Update"); }
    foreach (var ball in UnityEngine.GameObject.all) {
      var at = ball.transform.localPosition;
      System.Console.WriteLine(string.Format(System.Globalization.CultureInfo.InvariantCulture, "{0:R} {1:R} {2:R}", at.x, at.y, at.z));
    }
    System.Console.WriteLine(unity.doing);
    System.Environment.Exit(0);
  }
}

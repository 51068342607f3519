// Bodies and postures of a live run in Unity. Start `tritrack bridge websocket`, put this file below
// Assets and the component on an empty object: 15 balls move as the person does.
// TritrackStream and MessagePack below need nothing of Unity.
using System;
using System.Collections.Concurrent;
using System.Collections.Generic;
using System.IO;
using System.Net.WebSockets;
using System.Text;
using System.Threading;
using System.Threading.Tasks;
using UnityEngine;

public class TritrackBodies : MonoBehaviour
{
    public string address = "ws://127.0.0.1:8765/bodies";
    public int person = 0; // of several people the number of one; 0 in a run that follows one
    public string doing = ""; // the posture in progress
    readonly List<GameObject> balls = new List<GameObject>();
    TritrackStream stream;

    void OnEnable() { stream = new TritrackStream(address); }

    void OnDisable() { stream.Dispose(); }

    void Update()
    {
        while (stream.Messages.TryDequeue(out var message))
        {
            if (message.TryGetValue("body", out var body)) Show((Dictionary<string, object>)body);
            if (message.TryGetValue("posture", out var posture))
                doing = (string)((Dictionary<string, object>)posture)["doing"];
        }
    }

    void Show(Dictionary<string, object> body)
    {
        if (Convert.ToInt32(body["person"]) != person) return;
        var joints = (List<object>)body["joints_m"]; // empty while there is no pose
        for (int i = 0; i < joints.Count; i++)
        {
            if (balls.Count == i)
            {
                balls.Add(GameObject.CreatePrimitive(PrimitiveType.Sphere));
                balls[i].transform.parent = transform;
                balls[i].transform.localScale = new Vector3(0.1f, 0.1f, 0.1f);
            }
            var place = (List<object>)joints[i];
            // Unity's axes are left-handed: x changes its sign.
            balls[i].transform.localPosition = new Vector3(
                -Convert.ToSingle(place[0]), Convert.ToSingle(place[1]), Convert.ToSingle(place[2]));
        }
    }
}

// The messages of a bridge, oldest first; at most 256 wait, then the oldest is lost.
public sealed class TritrackStream : IDisposable
{
    public readonly ConcurrentQueue<Dictionary<string, object>> Messages = new ConcurrentQueue<Dictionary<string, object>>();
    readonly CancellationTokenSource over = new CancellationTokenSource();

    public TritrackStream(string address) { Task.Run(() => Listen(new Uri(address))); }

    public void Dispose() { over.Cancel(); }

    async Task Listen(Uri address)
    {
        while (!over.IsCancellationRequested)
        {
            try { await ListenOnce(address); }
            catch (Exception) when (!over.IsCancellationRequested) { } // no bridge yet, or no more
            try { await Task.Delay(1000, over.Token); } catch (OperationCanceledException) { }
        }
    }

    async Task ListenOnce(Uri address)
    {
        using (var socket = new ClientWebSocket())
        {
            socket.Options.AddSubProtocol("tritrack.msgpack");
            await socket.ConnectAsync(address, over.Token);
            var part = new ArraySegment<byte>(new byte[16384]);
            while (true)
            {
                var whole = new MemoryStream();
                WebSocketReceiveResult got;
                do
                {
                    got = await socket.ReceiveAsync(part, over.Token);
                    if (got.MessageType == WebSocketMessageType.Close) return;
                    whole.Write(part.Array, 0, got.Count);
                } while (!got.EndOfMessage);
                whole.Position = 0;
                Messages.Enqueue((Dictionary<string, object>)MessagePack.Read(whole));
                while (Messages.Count > 256) Messages.TryDequeue(out _);
            }
        }
    }
}

// What tritrack says, of MessagePack: nil, bool, whole numbers, doubles, text, bytes, lists, maps.
public static class MessagePack
{
    public static object Read(Stream from)
    {
        int kind = from.ReadByte();
        if (kind < 0) throw new EndOfStreamException();
        if (kind < 0x80) return (long)kind;
        if (kind < 0x90) return ReadMap(from, kind & 0x0f);
        if (kind < 0xa0) return ReadList(from, kind & 0x0f);
        if (kind < 0xc0) return ReadText(from, kind & 0x1f);
        if (kind >= 0xe0) return (long)(sbyte)kind;
        switch (kind)
        {
            case 0xc0: return null;
            case 0xc2: return false;
            case 0xc3: return true;
            case 0xc4: return ReadBytes(from, (int)ReadWhole(from, 1));
            case 0xc5: return ReadBytes(from, (int)ReadWhole(from, 2));
            case 0xc6: return ReadBytes(from, (int)ReadWhole(from, 4));
            case 0xca: return (double)BitConverter.ToSingle(Turned(from, 4), 0);
            case 0xcb: return BitConverter.ToDouble(Turned(from, 8), 0);
            case 0xcc: return (long)ReadWhole(from, 1);
            case 0xcd: return (long)ReadWhole(from, 2);
            case 0xce: return (long)ReadWhole(from, 4);
            case 0xcf: return (long)ReadWhole(from, 8);
            case 0xd0: return (long)(sbyte)ReadWhole(from, 1);
            case 0xd1: return (long)(short)ReadWhole(from, 2);
            case 0xd2: return (long)(int)ReadWhole(from, 4);
            case 0xd3: return (long)ReadWhole(from, 8);
            case 0xd9: return ReadText(from, (int)ReadWhole(from, 1));
            case 0xda: return ReadText(from, (int)ReadWhole(from, 2));
            case 0xdb: return ReadText(from, (int)ReadWhole(from, 4));
            case 0xdc: return ReadList(from, (int)ReadWhole(from, 2));
            case 0xdd: return ReadList(from, (int)ReadWhole(from, 4));
            case 0xde: return ReadMap(from, (int)ReadWhole(from, 2));
            case 0xdf: return ReadMap(from, (int)ReadWhole(from, 4));
            default: throw new InvalidDataException("MessagePack of kind " + kind);
        }
    }

    static Dictionary<string, object> ReadMap(Stream from, int count)
    {
        var map = new Dictionary<string, object>();
        for (int i = 0; i < count; i++) { var key = (string)Read(from); map[key] = Read(from); }
        return map;
    }

    static List<object> ReadList(Stream from, int count)
    {
        var list = new List<object>();
        for (int i = 0; i < count; i++) list.Add(Read(from));
        return list;
    }

    static string ReadText(Stream from, int count) { return Encoding.UTF8.GetString(ReadBytes(from, count)); }

    static byte[] ReadBytes(Stream from, int count)
    {
        var bytes = new byte[count];
        for (int got = 0; got < count;)
        {
            int more = from.Read(bytes, got, count - got);
            if (more == 0) throw new EndOfStreamException();
            got += more;
        }
        return bytes;
    }

    static ulong ReadWhole(Stream from, int count)
    {
        ulong value = 0;
        foreach (byte each in ReadBytes(from, count)) value = value << 8 | each;
        return value;
    }

    static byte[] Turned(Stream from, int count)
    {
        var bytes = ReadBytes(from, count);
        if (BitConverter.IsLittleEndian) Array.Reverse(bytes);
        return bytes;
    }
}
